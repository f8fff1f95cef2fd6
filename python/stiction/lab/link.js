// A scene in the address of the page: its text, compressed (raw deflate) and in base64url, behind `#scene=`.

const HEAD = "#scene=";
// Characters of a scene that a link may unpack to.
const MOST = 5_000_000;

async function through(stream, bytes) {
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
  const chunks = [];
  let length = 0;
  for (let read = await reader.read(); !read.done; read = await reader.read()) {
    chunks.push(read.value);
    length += read.value.length;
    if (length > MOST) throw new Error("the scene of the link is too long");
  }
  return new Uint8Array(await new Blob(chunks).arrayBuffer());
}

/** What stands behind the address of the page for a scene. */
export async function packed(scene) {
  const bytes = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(scene));
  const text = btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
  return HEAD + text.replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

/** The scene that an address has, or null. */
export async function unpacked(hash) {
  if (!hash.startsWith(HEAD)) return null;
  const text = atob(hash.slice(HEAD.length).replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  return new TextDecoder("utf-8", { fatal: true }).decode(
    await through(new DecompressionStream("deflate-raw"), bytes),
  );
}
