"use strict";
const byId = (id) => document.getElementById(id);

/** The levels, with what each asks, as docs/verification.md has it. */
const LEVELS = [
  ["safe", "can the archive be opened safely?"],
  ["fixity", "does every listed file match, is any unlisted?"],
  ["coherent", "do metadata, inputs, resolved study and records agree?"],
  ["derived", "does everything follow from manifest, inputs and records?"],
  ["sampled", "do trials, drawn with a fresh seed, give the same bytes again?"],
  ["full", "does every trial?"],
];
/** What exit codes of the command mean. */
const EXITS = ["yes", "no", "this program cannot judge that far", "this program failed"];
/** Trials that level 4 draws, as by the command. */
const SAMPLE = 59;
/** Trials that are executed again where nobody says how far to climb. */
const MOST_UNASKED = 200;
/** Most bytes of a bundle: a worker holds it, unpacked too, in 1 GiB. */
const MOST_BYTES = 256 * 2 ** 20;

/** What went wrong in the page, in words that are shown. */
class Told extends Error {}

/** Reads bytes as examples/assemble_page.rs writes them: their number, and five letters for each four of them. */
function fromLetters(text) {
  const begin = text.indexOf(" ") + 1, size = Number(text.slice(0, begin));
  const bytes = new Uint8Array(size + 3), view = new DataView(bytes.buffer);
  for (let at = begin, to = 0; to < size; at += 5, to += 4) {
    let number = 0;
    for (let i = at; i < at + 5; i++) {
      const code = text.charCodeAt(i);
      number = number * 85 + (code === 125 ? 25 : code - 35);
    }
    view.setUint32(to, number);
  }
  return bytes.subarray(0, size);
}

/** The module, unpacked and compiled once. */
const compiled = (async () => {
  const packed = fromLetters(byId("module").textContent);
  const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return WebAssembly.compile(await new Response(plain).arrayBuffer());
})();
compiled.catch(() => {});
const workerAt = URL.createObjectURL(new Blob([byId("worker").textContent], { type: "text/javascript" }));

/** A worker with a module of its own. */
class Checker {
  constructor(judged = () => {}) {
    this.worker = new Worker(workerAt);
    this.waiting = new Map();
    this.next = 0;
    this.worker.addEventListener("message", ({ data }) => {
      if (data.judged) return judged(data.judged);
      const { resolve, reject } = this.waiting.get(data.id);
      this.waiting.delete(data.id);
      if (data.memory) memoryPeak = Math.max(memoryPeak, data.memory);
      if (data.error === undefined) return resolve(data);
      const words = data.ended ? `a worker of this page ended: ${data.error}` : data.error;
      reject(Object.assign(new Told(words), { ended: Boolean(data.ended) }));
    });
    this.worker.addEventListener("error", (event) => {
      for (const { reject } of this.waiting.values()) reject(new Told(`a worker of this page ended: ${event.message || "no reason given"}`));
      this.waiting.clear();
    });
    this.ready = compiled.then((module) => this.post({ module }));
  }

  post(message) {
    const id = this.next++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ id, ...message });
    });
  }

  async ask(request, body) {
    await this.ready;
    return this.post({ request, body });
  }

  end() {
    this.worker.terminate();
    for (const { reject } of this.waiting.values()) reject(new Cancelled());
    this.waiting.clear();
  }
}

class Cancelled extends Error {}

// Shows a page in `frame`, which is laid out first: what draws by its window's size must find one. A page that nobody looks at is not
// laid out, and is not waited for.
async function framed(frame, bytes) {
  frame.hidden = false;
  await new Promise((goOn) => {
    requestAnimationFrame(() => setTimeout(goOn));
    setTimeout(goOn, 250);
  });
  frame.srcdoc = new TextDecoder().decode(bytes);
}

/** Most memory that a worker has taken (bytes). */
let memoryPeak = 0;
/** The check under way, or the last one. */
let check = null;

const seconds = (span) => span < 0.95 ? `${Math.max(0.01, span).toFixed(2)} s` : span < 90 ? `${span.toFixed(1)} s` : `${Math.round(span / 60)} min`;
const trialsOf = (n) => n === 1 ? "1 trial" : `${n.toLocaleString("en")} trials`;
const element = (name, text, look) => {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (look) made.className = look;
  return made;
};

/** A seed that nobody knows beforehand. */
function freshSeed() {
  const [high, low] = crypto.getRandomValues(new Uint32Array(2));
  return String((BigInt(high & 0x1fffff) << 32n) | BigInt(low));
}

function showRungs(top) {
  byId("rungs").replaceChildren(...LEVELS.map(([name, asks], level) => {
    const row = element("tr");
    row.id = `rung-${level}`;
    const head = element("th", `${level} ${name}`);
    head.scope = "row";
    row.append(head, element("td", asks, "asks"), element("td", "", "state waiting"), element("td", "", "took"));
    row.hidden = level > top;
    return row;
  }));
}

function showStates(states, current, took = []) {
  for (const { level, state } of states) {
    const row = byId(`rung-${level}`);
    const isCurrent = level === current;
    row.classList.toggle("current", isCurrent);
    const cell = row.querySelector(".state");
    const known = state === "passed" || state === "failed";
    cell.textContent = isCurrent && !known ? "…" : known ? `${state === "passed" ? "✓" : "✗"} ${state}` : current === undefined ? state : "";
    cell.className = `state ${known ? state : "waiting"}`;
  }
  for (const [level, span] of took) byId(`rung-${level}`).querySelector(".took").textContent = seconds(span);
}

function working(done, of, words) {
  const bar = byId("progress");
  byId("working").hidden = false;
  if (of) Object.assign(bar, { max: of, value: done });
  else bar.removeAttribute("value");
  byId("doing").textContent = words;
}

/** Shows the answer of a climb, in the words of the command. */
function showAnswer(answer, more = "") {
  const { report, human, exit } = answer;
  const box = byId("answer");
  box.className = `card answer ${["yes", "no", "open", "open"][exit]}`;
  const lines = human.trimEnd().split("\n");
  const last = lines[lines.length - 1];
  const title = element("h3", `${["✓", "✗", "○", "!"][exit]} ${last[0].toUpperCase()}${last.slice(1)}`);
  title.id = "verdict";
  const facts = element("dl", undefined, "facts");
  const fact = (name, value, look) => {
    if (!value) return;
    const part = element("div", undefined, look);
    part.append(element("dt", name), element("dd", value, look === "full" ? "digest" : ""));
    facts.append(part);
  };
  fact("study", report.name);
  fact("engine", report.engine);
  fact("exit code of the command", `${exit}: ${EXITS[exit]}`);
  const signed = lines.find((line) => line.startsWith("signed "));
  fact("signed", signed ? signed.slice(9) : "");
  fact("results", report.results_digest, "full");
  fact("bundle", report.bundle_id, "full");
  const findings = element("ul");
  // What the command says between the last level and its last line: findings, and what was executed.
  const after = lines.findLastIndex((line) => /^ {2}\d /.test(line));
  for (const line of lines.slice(after + 1, -1)) {
    if (line.startsWith("    ") && findings.lastChild) findings.lastChild.append(`\n${line}`);
    else findings.append(element("li", line));
  }
  box.replaceChildren(title, ...(more ? [element("p", more)] : []), ...(findings.children.length ? [findings] : []), facts);
  box.hidden = false;
  byId("said").textContent = human;
  byId("said-part").hidden = false;
}

/** Says that there is no answer. */
function showFailure(words, exit = 3) {
  const box = byId("answer");
  box.className = "card answer open";
  const title = element("h3", exit === 3 ? "! This page failed, which says nothing of the bundle" : "○ The request was not understood");
  title.id = "verdict";
  const name = check?.name ?? "BUNDLE";
  const way = exit === 3 ? `The command has no limit of this page: reenact verify --level 5 ${name}` : "";
  box.replaceChildren(title, element("p", words), ...(way ? [element("p", way, "soft")] : []));
  box.hidden = false;
}

function ended() {
  byId("working").hidden = true;
  byId("cancel").hidden = true;
}

/** Climbs with a bundle from the start. */
async function begin(name, bytes) {
  check?.end();
  const chosen = byId("level").value;
  check = new Check(name, bytes, chosen === "auto" ? null : Number(chosen));
  byId("chosen").textContent = `${name} (${(bytes.length / 1e6).toFixed(2)} MB)`;
  for (const id of ["answer", "said-part", "replays", "findings", "report", "replay", "further", "refused"]) byId(id).hidden = true;
  byId("ladder").hidden = false;
  byId("cancel").hidden = false;
  await check.run();
}

class Check {
  constructor(name, bytes, asked) {
    Object.assign(this, { name, bytes, asked, checkers: [], seed: freshSeed(), isOver: false, began: performance.now() });
  }

  start(judged) {
    const checker = new Checker(judged);
    this.checkers.push(checker);
    return checker;
  }

  /** Ends every worker at once. */
  end() {
    this.isOver = true;
    for (const checker of this.checkers) checker.end();
    this.checkers = [];
  }

  climb(level) {
    const now = Math.floor(Date.now() / 1000);
    return this.main.ask({ do: "climb", level, sample: SAMPLE, seed: this.seed, now }).then(({ told }) => told);
  }

  async run() {
    try {
      if (this.bytes.length > MOST_BYTES) {
        throw new Told(`expected a bundle of at most ${MOST_BYTES} bytes, found ${this.bytes.length}: a worker of this page holds it in memory`);
      }
      const top = this.asked ?? 5;
      showRungs(top);
      working(0, 0, "starting the checker");
      this.current = 0;
      this.main = this.start((states) => {
        const judged = states.filter(({ state }) => state !== "not judged").length;
        if (!this.isExecuted) showStates(states, judged < states.length ? judged : undefined);
      });
      for (const [request, id] of [["trust", "trust"], ["signature", "signature"]]) {
        const file = byId(id).files[0];
        if (!file) continue;
        try {
          await this.main.ask({ do: request, name: file.name }, new Uint8Array(await file.arrayBuffer()));
        } catch (error) {
          throw error instanceof Told ? Object.assign(error, { exit: 2 }) : error;
        }
      }
      await this.main.ask({ do: "open" }, this.bytes);
      working(0, 0, "levels 0 to 3: reading, comparing, deriving everything again");
      const lower = await this.climb(3);
      this.seconds = new Map(lower.seconds);
      this.lower = lower;
      showStates(lower.report.levels, undefined, lower.seconds);
      this.shown = this.show(lower);
      // Whoever awaits it tells of its faults; where the climb is cancelled before that, nobody does.
      this.shown.catch(() => {});
      if (lower.exit === 0 && top > 3) await this.upper(top);
      else if (top > 3) this.tell(await this.climb(top), top);
      else this.tell(lower, 3);
      await this.shown;
    } catch (error) {
      this.failed(error);
    }
    if (check === this) ended();
  }

  tell(answer, top, more) {
    showStates(answer.report.levels, undefined);
    showAnswer(answer, more);
    document.documentElement.dataset.level = String(answer.report.reached ?? "none");
    document.documentElement.dataset.exit = String(answer.exit);
    document.documentElement.dataset.seconds = ((performance.now() - this.began) / 1000).toFixed(2);
    document.documentElement.dataset.memory = String(memoryPeak);
  }

  failed(error) {
    if (error instanceof Cancelled || this.isOver) return;
    for (const checker of this.checkers) checker.end();
    this.checkers = [];
    document.documentElement.dataset.exit = String(error.exit ?? 3);
    showFailure(error.message, error.exit);
  }

  /** Climbs to level 4 or 5 with all cores. */
  async upper(top) {
    showAnswer(this.lower, "Levels above are being judged.");
    let level = top;
    let count = await this.errand(level);
    const isShorter = this.asked === null && count > MOST_UNASKED;
    if (isShorter) {
      this.all = count;
      level = 4;
      count = await this.errand(level);
    }
    byId("rung-5").hidden = level < 5;
    this.isExecuted = true;
    const spans = this.lower.report.levels.concat([4, 5].filter((n) => n <= level).map((n) => ({ level: n, state: "" })));
    showStates(spans, level);
    const began = performance.now();
    const lines = await this.execute(level, count);
    const took = (performance.now() - began) / 1000;
    working(count, count, "comparing");
    await this.main.ask({ do: "executed" }, new TextEncoder().encode(lines));
    const answer = await this.climb(level);
    showStates(answer.report.levels, undefined, [[level, took]]);
    this.tell(answer, level);
    if (isShorter) {
      byId("further").textContent = `Climb on to level 5: ${trialsOf(this.all)}, about ${seconds(took / count * this.all)}`;
      byId("further").hidden = false;
    }
    if (answer.exit !== 0) await this.show(answer);
  }

  errand(level) {
    return this.main.ask({ do: "errand", level, sample: SAMPLE, seed: this.seed }).then(({ told }) => told.trials);
  }

  /** Executes the errand's trials on all cores; gives the lines of their records. */
  async execute(level, count) {
    const lines = new Array(count), began = performance.now();
    const workers = Math.max(1, Math.min(navigator.hardwareConcurrency || 1, count, 32));
    let next = 0, done = 0;
    const tell = () => {
      const left = done ? (performance.now() - began) / 1000 / done * (count - done) : 0;
      const rest = done && left > 1 ? `, about ${seconds(left)} left` : "";
      working(done, count, `${done} of ${trialsOf(count)} executed again on ${workers} core${workers === 1 ? "" : "s"}${rest}`);
    };
    tell();
    await Promise.all(Array.from({ length: workers }, async () => {
      const checker = this.start();
      await checker.ask({ do: "open" }, this.bytes);
      await checker.ask({ do: "errand", level, sample: SAMPLE, seed: this.seed });
      while (next < count) {
        const number = next++;
        const { bytes } = await checker.ask({ do: "execute", number });
        lines[number] = new TextDecoder().decode(bytes);
        done += 1;
        tell();
      }
      checker.end();
    }));
    return lines.map((line) => `${line}\n`).join("");
  }

  /** Shows the report and what can be played, as far as the bundle may be shown. */
  async show(answer, unchecked = false) {
    byId("findings").hidden = !answer.is_read;
    const notice = byId("refused");
    notice.hidden = !answer.refused || unchecked;
    if (!answer.is_read) return;
    if (answer.refused && !unchecked) {
      notice.querySelector("span").textContent = `${answer.words}.`;
      for (const id of ["report", "replays", "replay"]) byId(id).hidden = true;
      byId("report-told").textContent = "";
      return;
    }
    try {
      const report = await this.main.ask({ do: "report", unchecked });
      await framed(byId("report"), report.bytes);
      byId("report-told").textContent = `${report.told.words[0].toUpperCase()}${report.told.words.slice(1)}. The page that reenact report makes:`;
      const { told } = await this.main.ask({ do: "trials" });
      this.unchecked = unchecked;
      this.offer(told);
    } catch (error) {
      if (error instanceof Cancelled || error.ended) throw error;
      byId("report-told").textContent = `No report: ${error.message}`;
    }
  }

  /** Offers the trials to be played. */
  offer({ conditions }) {
    const pick = (legend, none) => {
      const set = element("fieldset");
      set.append(element("legend", legend));
      const condition = element("select"), trial = element("select");
      condition.setAttribute("aria-label", `condition of the ${legend} trial`);
      trial.setAttribute("aria-label", `number of the ${legend} trial`);
      if (none) condition.append(new Option("none", ""));
      for (const { slug, label } of conditions) condition.append(new Option(label, slug));
      const fill = () => {
        const known = conditions.find(({ slug }) => slug === condition.value);
        trial.replaceChildren(...(known?.trials ?? []).map((number) => new Option(`trial ${number}`, number)));
        trial.hidden = !known;
      };
      condition.addEventListener("change", fill);
      fill();
      set.append(condition, trial);
      return { set, name: () => condition.value ? `${condition.value}/${trial.value}` : null, condition, fill };
    };
    const first = pick("first", false), second = pick("second", true);
    if (conditions.length > 1) second.condition.value = conditions[1].slug;
    second.fill();
    const button = element("button", "▶ Play");
    button.type = "button";
    button.id = "play";
    button.addEventListener("click", () => this.play([first.name(), second.name()].filter(Boolean), button));
    byId("pickers").replaceChildren(first.set, second.set, button);
    byId("played").textContent = "";
    byId("replays").hidden = false;
  }

  async play(trials, button) {
    button.disabled = true;
    byId("played").textContent = `executing ${trials.join(" and ")} again`;
    try {
      const { told, bytes } = await this.main.ask({ do: "replay", trials, unchecked: this.unchecked });
      await framed(byId("replay"), bytes);
      byId("played").textContent = told.notes.map(([text, good]) => `${good ? "✓" : "✗"} ${text}`).join("; ");
    } catch (error) {
      if (!(error instanceof Cancelled)) byId("played").textContent = error.message;
      if (error.ended) this.failed(error);
    }
    button.disabled = false;
  }
}

const choose = async (file) => {
  if (file) await begin(file.name, new Uint8Array(await file.arrayBuffer()));
};
byId("file").addEventListener("change", (event) => {
  const [file] = event.target.files;
  choose(file);
  // The same file again is another check.
  event.target.value = "";
});
for (const kind of ["dragover", "dragleave", "drop"]) {
  addEventListener(kind, (event) => {
    event.preventDefault();
    document.body.classList.toggle("dragged", kind === "dragover");
    if (kind === "drop") choose(event.dataTransfer.files[0]);
  });
}
byId("cancel").addEventListener("click", () => {
  const { lower } = check;
  check.end();
  ended();
  byId("doing").textContent = "";
  if (lower) showAnswer(lower, "Cancelled: what is above was not judged.");
  else showFailure("cancelled before anything was judged", 2);
  if (lower) showStates(lower.report.levels.concat([4, 5].map((level) => ({ level, state: "not judged" }))), undefined);
});
byId("further").addEventListener("click", () => {
  byId("level").value = "5";
  begin(check.name, check.bytes);
});
byId("unchecked").addEventListener("click", () => {
  check.show({ is_read: true, refused: true, words: "" }, true).catch((error) => check.failed(error));
});

// A site may lead to its own bundle, and to no other's.
(async () => {
  const wanted = new URLSearchParams(location.search).get("bundle");
  if (!wanted) return;
  byId("ladder").hidden = false;
  try {
    const at = new URL(wanted, location.href);
    if (!/^https?:$/.test(at.protocol) || at.origin !== location.origin) {
      throw new Told(`?bundle=${wanted}: expected the address of a bundle on this page's own site`);
    }
    working(0, 0, `fetching ${at.pathname}`);
    const answer = await fetch(at, { credentials: "omit", redirect: "error" });
    if (!answer.ok) throw new Told(`${at.pathname}: expected a bundle, found ${answer.status} ${answer.statusText}`);
    await begin(decodeURIComponent(at.pathname.split("/").pop()), new Uint8Array(await answer.arrayBuffer()));
  } catch (error) {
    ended();
    showFailure(error.message, 2);
  }
})();
