#!/bin/sh
# Builds the core of `stiction lab`, the module of WebAssembly that the page computes with: target/lab/stiction.wasm, and a copy
# next to the page where that is there. Exit code 77 where this machine has no compiler for it.
#
# The compiler is that of rustup with its target wasm32-unknown-unknown, or Debian's rustc-web, cargo-web, rust-web-src and
# lld, which build the standard library too.
set -eu

cd "$(dirname -- "$0")/.."
triple=wasm32-unknown-unknown
output=${CARGO_TARGET_DIR:-target}
features="--no-default-features --features lab --lib --profile lab --locked"
# Browsers have these instructions since 2021. They change no bit: nothing is fused or reordered.
export RUSTFLAGS="-C target-feature=+simd128"

has_target() {
    sysroot=$(rustc --print sysroot 2>/dev/null) && [ -d "$sysroot/lib/rustlib/$triple/lib" ]
}

if command -v rustup >/dev/null 2>&1 && ! has_target; then
    rustup target add $triple >/dev/null 2>&1 </dev/null || true
fi
# shellcheck disable=SC2086
if command -v cargo >/dev/null 2>&1 && has_target; then
    cargo rustc --crate-type cdylib --target $triple $features
elif [ -x /usr/bin/cargo ] && /usr/bin/rustc --print target-list 2>/dev/null | grep -qx $triple &&
    [ -d "$(/usr/bin/rustc --print sysroot)/lib/rustlib/src/rust/library" ]; then
    output=target/web
    RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 /usr/bin/cargo rustc -Z build-std=std,panic_abort --target-dir $output \
        --crate-type cdylib --target $triple $features
else
    echo "lab.sh: no compiler for $triple: rustup target add $triple," \
        "or apt-get install rustc-web cargo-web rust-web-src lld" >&2
    exit 77
fi

mkdir -p target/lab
cp "$output/$triple/lab/stiction.wasm" target/lab/stiction.wasm
[ ! -d python/stiction/lab ] || cp target/lab/stiction.wasm python/stiction/lab/stiction.wasm
size=$(gzip -9 -c target/lab/stiction.wasm | wc -c)
echo "target/lab/stiction.wasm: $(wc -c <target/lab/stiction.wasm) bytes, $size compressed"
