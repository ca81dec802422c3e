"use strict";
// One module of the checker: what crosses its border is told in page/src/lib.rs. Shared by the page's workers and by Node.

/** Why a module ended: it panicked, ran out of memory or of stack. Whoever hears it starts another. */
class Ended extends Error {}

class Engine {
  /** Starts a module, which calls `judged` with the states of the levels whenever one has been judged. */
  static async start(module, judged = () => {}) {
    const engine = new Engine();
    engine.why = "";
    const given = {
      judged: (at, length) => judged(JSON.parse(engine.text(at, length))),
      panicked: (at, length) => { engine.why = engine.text(at, length); },
      exhausted: () => { engine.why = "out of memory: a worker of this page has 1 GiB"; },
      seconds: () => performance.now() / 1000,
    };
    const { exports } = await WebAssembly.instantiate(module, { page: given });
    engine.exports = exports;
    return engine;
  }

  text(at, length) {
    return new TextDecoder().decode(new Uint8Array(this.exports.memory.buffer, at >>> 0, length));
  }

  /** How much memory the module took at most: it never gives any back. */
  get memory() {
    return this.exports.memory.buffer.byteLength;
  }

  /** Asks for something; gives what was told and the bytes that belong to it. Throws `Ended` where the module ended. */
  ask(request, body = new Uint8Array()) {
    const header = new TextEncoder().encode(JSON.stringify(request));
    const length = 4 + header.length + body.length;
    let told, bytes;
    try {
      const at = this.exports.allocate(length) >>> 0;
      const memory = new Uint8Array(this.exports.memory.buffer, at, length);
      new DataView(memory.buffer, at).setUint32(0, header.length, true);
      memory.set(header, 4);
      memory.set(body, 4 + header.length);
      const packed = BigInt.asUintN(64, this.exports.answer(at, length));
      const place = Number(packed >> 32n), size = Number(packed & 0xffffffffn);
      const answer = new Uint8Array(this.exports.memory.buffer, place, size);
      const end = 4 + new DataView(answer.buffer, place).getUint32(0, true);
      told = JSON.parse(new TextDecoder().decode(answer.subarray(4, end)));
      bytes = answer.slice(end);
      this.exports.release(place, size);
    } catch (error) {
      const deep = error instanceof RangeError ? "out of stack: something is nested too deeply" : String(error);
      throw new Ended(this.why || deep);
    }
    if (told.error !== undefined) throw new Error(told.error);
    return { told, bytes };
  }
}
