//! How much memory the module may ever take, and how deep it may call.

/// Most bytes of memory. A hostile bundle that asks for more ends its worker, not the browser.
const MOST_MEMORY: u32 = 1 << 30;

/// Bytes of the stack: those of the main thread of a program.
const STACK: u32 = 8 << 20;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_FAMILY").is_ok_and(|family| family == "wasm") {
        println!("cargo::rustc-link-arg-cdylib=--max-memory={MOST_MEMORY}");
        println!("cargo::rustc-link-arg-cdylib=-zstack-size={STACK}");
    }
}
