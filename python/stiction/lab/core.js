// The program's core, stiction.wasm: text or bytes in, JSON or bytes out.

/** What the program refuses, in its words, with the lines and keys of a scene. */
export class ProgramError extends Error {
  constructor({ text, problems = [] }) {
    super(text);
    this.problems = problems;
  }
}

export class Core {
  /** An instance of a compiled module; it holds the scene that was prepared last. */
  constructor(module) {
    this.module = module;
    this.restart();
  }

  static async compiled(address) {
    return WebAssembly.compileStreaming(fetch(address));
  }

  restart() {
    this.exports = new WebAssembly.Instance(this.module, {}).exports;
  }

  /** The bytes that a function of the module returns for a text or bytes. */
  call(name, argument = "") {
    try {
      return this.#called(name, argument);
    } catch (error) {
      if (!(error instanceof WebAssembly.RuntimeError)) throw error;
      // A bug of the program; the instance is not to be used any more.
      const text = this.#reason() || error.message;
      this.restart();
      throw new ProgramError({ text });
    }
  }

  /** The object that a function of the module returns. */
  ask(name, argument = "") {
    const given =
      typeof argument === "string" || argument instanceof Uint8Array ? argument : JSON.stringify(argument);
    const reply = JSON.parse(new TextDecoder().decode(this.call(name, given)));
    if (reply.error) throw new ProgramError(reply.error);
    return reply;
  }

  #called(name, argument) {
    const { memory, allocate, release } = this.exports;
    const bytes = typeof argument === "string" ? new TextEncoder().encode(argument) : argument;
    const at = allocate(bytes.length);
    new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
    const reply = this.exports[name](at, bytes.length);
    release(at, bytes.length);
    const count = new DataView(memory.buffer).getUint32(reply, true);
    const out = new Uint8Array(memory.buffer, reply + 4, count).slice();
    release(reply, 4 + count);
    return out;
  }

  #reason() {
    try {
      return new TextDecoder().decode(this.#called("failure", ""));
    } catch {
      return "";
    }
  }
}

/** The head of a computed piece: its replicas and their pull-offs. */
export function head(bytes) {
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true);
  return JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
}

/** The bytes of a computed piece; throws where they are an error in its place. */
export function piece(bytes) {
  const begin = new TextDecoder().decode(bytes.subarray(0, 8));
  if (begin === '{"error"') throw new ProgramError(JSON.parse(new TextDecoder().decode(bytes)).error);
  return bytes;
}
