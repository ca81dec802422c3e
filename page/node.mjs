// The page's module in Node: what the page does in a browser, by the same engine.js.
//
//   node page/node.mjs run MODULE [--trials N] [--only FACTOR=VALUE]... MANIFEST...     (--out and --format are passed over)
//   node page/node.mjs verify MODULE LEVEL BUNDLE [--seed S]
//   node page/node.mjs adversary MODULE FOLDER
//
// `run` prints the results digest of each manifest, as `reenact run --format json` does; `verify` what the command prints, times and memory on stderr, and ends with the
// exit code that the command has; `adversary` holds what is said of every bundle of a table (`.ci/page-check`) against what the
// command says of it.
import { readFileSync, readdirSync, existsSync, statSync } from "node:fs";
import { dirname, join, posix, relative, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const { Engine, Ended } = new Function(readFileSync(join(here, "engine.js"), "utf8") + "\nreturn { Engine, Ended };")();

const [task, path, ...rest] = process.argv.slice(2);
const module = await WebAssembly.compile(readFileSync(path));
const start = () => Engine.start(module);
const seconds = (began) => ((performance.now() - began) / 1000).toFixed(2);
const now = () => Math.floor(Date.now() / 1000);

/** Every file below the folders that manifests name, as one beside `manifest` names it. */
function filesFor(manifest) {
  const root = resolve(dirname(manifest), "..");
  const names = [];
  const walk = (folder) => {
    for (const name of readdirSync(folder).sort()) {
      const at = join(folder, name);
      if (statSync(at).isDirectory()) walk(at);
      else names.push(at);
    }
  };
  for (const folder of ["manifests", "robots", "worlds"]) if (existsSync(join(root, folder))) walk(join(root, folder));
  const files = names.map((name) => [relative(dirname(resolve(manifest)), name).split("\\").join(posix.sep), readFileSync(name)]);
  return { files: files.map(([name, bytes]) => [name, bytes.length]), body: Buffer.concat(files.map(([, bytes]) => bytes)) };
}

async function run() {
  const asked = { only: [], trials: null }, manifests = [];
  for (let i = 0; i < rest.length; i++) {
    if (rest[i] === "--trials") asked.trials = Number(rest[++i]);
    else if (rest[i] === "--only") asked.only.push(rest[++i]);
    else if (rest[i] === "--out" || rest[i] === "--format") i += 1;
    else manifests.push(rest[i]);
  }
  for (const manifest of manifests) {
    const engine = await start(), began = performance.now();
    const { files, body } = filesFor(manifest);
    const request = { do: "run", manifest: posix.basename(manifest), files, ...asked };
    const { told } = engine.ask(request, body);
    if (told.failed) throw new Error(`${told.failed} trials failed`);
    console.error(`${manifest}: ${told.trials} trials in ${seconds(began)} s, ${engine.memory >> 20} MiB`);
    console.log(JSON.stringify(told));
  }
}

/** What the page does to check a bundle, on one thread. */
async function check(bytes, level, seed) {
  const engine = await start();
  engine.ask({ do: "open" }, bytes);
  const climb = (level) => engine.ask({ do: "climb", level, sample: 59, seed, now: now() }).told;
  const began = performance.now();
  let answer = climb(Math.min(level, 3));
  const lower = seconds(began);
  let trials = 0;
  if (level > 3 && answer.exit === 0) {
    trials = engine.ask({ do: "errand", level, sample: 59, seed }).told.trials;
    const lines = [];
    for (let number = 0; number < trials; number++) lines.push(engine.ask({ do: "execute", number }).bytes);
    engine.ask({ do: "executed" }, Buffer.concat(lines.flatMap((line) => [line, Buffer.from("\n")])));
  }
  // As the page does: what the lower levels find wrong is told of the level that was asked for.
  if (level > 3) answer = climb(level);
  return { answer, lower, all: seconds(began), trials, memory: engine.memory };
}

async function verify() {
  const seed = rest.includes("--seed") ? rest[rest.indexOf("--seed") + 1] : "1";
  const { answer, lower, all, trials, memory } = await check(readFileSync(rest[1]), Number(rest[0]), seed);
  process.stdout.write(answer.human);
  console.error(`level 3 in ${lower} s; everything in ${all} s, ${trials} trials executed, ${memory >> 20} MiB`);
  process.exitCode = answer.exit;
}

/** Asks for more memory than a worker may have: the module ends and says why, and another one starts. */
async function capped() {
  const engine = await start();
  let said = "nothing";
  try {
    engine.ask({ do: "open" }, Buffer.alloc(1 << 30));
  } catch (error) {
    said = error instanceof Ended ? error.message : `${error}`;
  }
  const expected = "out of memory: a worker of this page has 1 GiB";
  if (said === expected && engine.memory <= 1 << 30) return true;
  console.log(`FAIL  a worker that wants 1 GiB and more says: ${said}; expected: ${expected}; it took ${engine.memory >> 20} MiB`);
  return false;
}

async function adversary() {
  const table = JSON.parse(readFileSync(join(rest[0], "table.json"), "utf8"));
  let failed = 0, peak = 0, slowest = 0;
  for (const { name, file, level, exit, said } of table) {
    const began = performance.now();
    let found;
    try {
      const { answer, memory } = await check(readFileSync(join(rest[0], file)), level, "1");
      peak = Math.max(peak, memory);
      found = { exit: answer.exit, said: answer.human };
    } catch (error) {
      found = { exit: 3, said: `${error instanceof Ended ? "the module ended: " : ""}${error.message}\n` };
    }
    slowest = Math.max(slowest, performance.now() - began);
    if (found.exit !== exit || found.said !== said) {
      failed += 1;
      console.log(`FAIL  ${name}\n--- the command: exit code ${exit}\n${said}--- the page: exit code ${found.exit}\n${found.said}`);
    }
  }
  console.log(`${table.length - failed} of ${table.length} attacks are told as by the command; at most ${peak >> 20} MiB and ` +
    `${(slowest / 1000).toFixed(2)} s`);
  if (!(await capped()) || failed || !table.length) process.exitCode = 1;
}

const tasks = { run, verify, adversary };
if (!tasks[task]) {
  console.error(`no task \`${task}\`: expected run, verify or adversary`);
  process.exit(2);
}
try {
  await tasks[task]();
} catch (error) {
  console.error(error.message);
  process.exitCode = 3;
}
