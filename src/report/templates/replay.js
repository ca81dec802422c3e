
const trials = JSON.parse(document.getElementById("data").textContent).map(unpackTrial);
const element = (id) => document.getElementById(id);
const make = (name, className, text) => {
  const node = document.createElement(name);
  if (className) node.className = className;
  if (text !== undefined) node.textContent = text;
  return node;
};

// --- time ------------------------------------------------------------------------------------------------

const end = Math.max(0, ...trials.map((trial) => trial.time.at(-1) ?? 0));
const merged = (lists) => [...new Set(lists.flat())].sort((a, b) => a - b);
const instants = merged(trials.map((trial) => trial.time));
const decisions = merged(trials.map((trial) => trial.decisions.map(([at]) => trial.time[at])));
let now = 0, playing = false, last = 0;

// The number of the last of `count` ascending values `value(i)` that is at most `limit`; -1 for none.
function lastAt(count, value, limit) {
  let low = 0, high = count;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (value(middle) <= limit) low = middle + 1; else high = middle;
  }
  return low - 1;
}
const frameAt = (trial) => lastAt(trial.time.length, (i) => trial.time[i], now + 1e-6);
const latest = (list, frame) => list[lastAt(list.length, (i) => list[i][0], frame)];

// --- one panel per trial ---------------------------------------------------------------------------------

function panelOf(trial) {
  const section = make("section", "card trial");
  section.setAttribute("aria-label", trial.name);
  const view = make("div", "view"), side = make("div");
  const canvas = make("canvas");
  canvas.setAttribute("role", "img");
  const status = make("p", "now");
  const scroll = make("div", "scroll"), table = make("table", "decision"), events = make("ul", "events");
  scroll.append(table);
  side.append(status, scroll, events);
  view.append(canvas, side);
  const heading = make("h2", "", trial.name);
  if (trials.length > 1) heading.prepend(swatch(trials.indexOf(trial)));
  section.append(heading, view);
  element("trials").append(section);
  const cells = new Uint8Array(trial.frame.width * trial.frame.height);
  return { trial, canvas, status, table, events, cells, map: picture(trial.frame), applied: -1, stale: true };
}

function drawPanel(panel) {
  const { trial } = panel, frame = frameAt(trial), view = viewport(panel), { context } = view;
  context.fillStyle = colour.unknown;
  context.fillRect(0, 0, view.width, view.height);
  const shown = (name) => document.querySelector(`[data-layer=${name}]`).checked;
  const decision = latest(trial.decisions, frame);
  if (shown("map")) {
    advanceMap(panel, frame);
    drawGrid(view, panel.map, trial.frame, trial.pose, 1);
  }
  if (shown("prior") && panel.prior) drawGrid(view, panel.prior, trial.prior.frame, [0, 0, 0], 0.6);
  if (shown("world")) drawWorld(view, trial);
  if (frame >= 0) {
    if (shown("scan")) drawScan(view, trial, frame);
    if (shown("path")) drawPath(view, trial, frame);
    if (shown("frontiers") && decision) drawFrontiers(view, trial, decision[1]);
    drawRobot(view, trial, frame);
  }
  drawScale(view);
  tell(panel, frame, decision);
}

// --- the side panel --------------------------------------------------------------------------------------

function tell(panel, frame, decision) {
  const { trial } = panel;
  let text = "not begun";
  if (frame >= 0) {
    const [time, distance, coverage] = [trial.time[frame], trial.distance[frame], trial.coverage[frame]];
    const ended = now > trial.time.at(-1) ? " · ended" : "";
    text = `${time.toFixed(1)} s · ${distance.toFixed(2)} m · ${coverage.toFixed(1)} % covered${ended}`;
  }
  panel.status.textContent = text;
  panel.canvas.setAttribute("aria-label", `${trial.name}: map, frontiers, path and robot; ${text}`);
  if (panel.decision !== decision) {
    panel.decision = decision;
    panel.table.replaceChildren(...(decision ? decisionRows(trial, decision) : []));
  }
  const count = lastAt(trial.events.length, (i) => trial.events[i][0], frame) + 1;
  if (panel.told !== count) {
    panel.told = count;
    const recent = trial.events.slice(Math.max(0, count - 4), count).reverse();
    panel.events.replaceChildren(...recent.map(([at, event]) =>
      make("li", "", `${trial.time[at].toFixed(1)} s  ${event}`)));
  }
}

function decisionRows(trial, [at, decision]) {
  const MOST = 8;
  const row = (cells, name, className) => {
    const line = make("tr", className);
    line.append(...cells.map((text) => make(name, "", text)));
    return line;
  };
  const when = `decision at ${trial.time[at].toFixed(1)} s`;
  if (!decision.frontiers.length) return [make("caption", "", `${when}: no frontier is left`)];
  const rows = [make("caption", "", `${when}: distance D, gain I, utility u`),
    row(["", "D (m)", "I (m²)", "u"], "th")];
  for (const i of decision.ranked) {
    const { rank, distance, gain, utility } = decision.frontiers[i], chosen = i === decision.chosen;
    if (rank > MOST && !chosen) continue;
    const numbers = [distance.toFixed(2), gain.toFixed(2), utility.toFixed(3)];
    rows.push(row([`${chosen ? "◆ " : ""}${rank}`, ...numbers], "td", chosen ? "chosen" : ""));
  }
  const more = decision.frontiers.length - rows.length + 2;
  if (more > 0) rows.push(row(["", `and ${more} more`, "", ""], "td", "soft"));
  return rows;
}

// --- coverage over time ----------------------------------------------------------------------------------

const chart = element("coverage");
const looks = [["ink", []], ["path", [7, 4]], ["chosen", [2, 3]]];
const inset = { left: 44, right: 16, top: 10, bottom: 30 };

function drawChart() {
  const ratio = window.devicePixelRatio || 1, width = chart.clientWidth, height = chart.clientHeight;
  chart.width = Math.round(width * ratio);
  chart.height = Math.round(height * ratio);
  const context = chart.getContext("2d");
  context.scale(ratio, ratio);
  const px = (t) => inset.left + (width - inset.left - inset.right) * t / (end || 1);
  const py = (c) => height - inset.bottom - (height - inset.top - inset.bottom) * c / 100;
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "right";
  for (const c of [0, 50, 100]) {
    context.strokeStyle = colour.edge;
    context.lineWidth = 1;
    trace(context, [[0, c], [end, c]], ([t, v]) => [px(t), py(v)], false);
    context.stroke();
    context.fillStyle = colour.soft;
    context.fillText(`${c} %`, inset.left - 6, py(c) + 4);
  }
  const step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000].find((s) => end / s <= width / 90) ?? 10000;
  context.textAlign = "center";
  for (let t = 0; t <= end; t += step) context.fillText(`${t} s`, px(t), height - 10);
  trials.forEach((trial, i) => {
    const [name, dash] = looks[i % looks.length], stroke = colour[name], frame = frameAt(trial);
    context.strokeStyle = context.fillStyle = stroke;
    context.lineWidth = 2;
    context.setLineDash(dash);
    trace(context, trial.time.map((t, k) => [t, trial.coverage[k]]), ([t, c]) => [px(t), py(c)], false);
    context.stroke();
    context.setLineDash([]);
    if (frame < 0) return;
    disc(context, [px(trial.time[frame]), py(trial.coverage[frame])], 4.5);
    context.fill();
    // Named at the lower right where there is room; the headings of the trials show their lines anyway.
    context.textAlign = "right";
    const y = py(0) - 8 - 16 * (trials.length - 1 - i);
    if (trials.length > 1 && width > 600) {
      halo(context, trial.name, width - inset.right - 40, y);
      context.strokeStyle = stroke;
      context.lineWidth = 2;
      context.setLineDash(dash);
      trace(context, [[width - inset.right - 32, y - 4], [width - inset.right, y - 4]], (p) => p, false);
      context.stroke();
      context.setLineDash([]);
    }
  });
  context.strokeStyle = colour.ink;
  context.lineWidth = 1;
  trace(context, [[now, 0], [now, 100]], ([t, c]) => [px(t), py(c)], false);
  context.stroke();
}

// The line of trial `i`, for its heading.
function swatch(i) {
  const [name, dash] = looks[i % looks.length];
  // The name space is taken from the page's own drawings.
  const space = document.querySelector("svg").namespaceURI;
  const svg = document.createElementNS(space, "svg");
  svg.setAttribute("viewBox", "0 0 30 10");
  svg.setAttribute("aria-hidden", "true");
  const line = document.createElementNS(space, "path");
  const attributes = { d: "M0 5H30", stroke: `var(--${name})`, "stroke-width": 2.5 };
  if (dash.length) attributes["stroke-dasharray"] = dash.join(" ");
  for (const [key, value] of Object.entries(attributes)) line.setAttribute(key, value);
  svg.append(line);
  return svg;
}

// --- playing ---------------------------------------------------------------------------------------------

const panels = trials.map(panelOf);
const scrub = element("scrub"), speed = element("speed");

function draw() {
  panels.forEach(drawPanel);
  drawChart();
  scrub.value = Math.round(now * 1000);
  const text = `${now.toFixed(1)} of ${end.toFixed(1)} s`;
  element("clock").textContent = text;
  scrub.setAttribute("aria-valuetext", text);
}

function seek(instant) {
  now = Math.max(0, Math.min(end, instant));
  draw();
}

function play(on) {
  playing = on && end > 0;
  element("play").textContent = playing ? "❚❚ pause" : "▶ play";
  if (!playing) return;
  if (now >= end) now = 0;
  last = performance.now();
  requestAnimationFrame(tick);
}

function tick(stamp) {
  if (!playing) return;
  const passed = Math.max(0, stamp - last) / 1000;
  last = stamp;
  seek(now + passed * Number(speed.value));
  if (now >= end) play(false); else requestAnimationFrame(tick);
}

// To the neighbour of the present instant in an ascending list.
function step(list, forth) {
  play(false);
  const at = lastAt(list.length, (i) => list[i], now + (forth ? 1e-6 : -1e-6));
  seek(list[Math.max(0, Math.min(list.length - 1, at + (forth ? 1 : 0)))] ?? 0);
}

element("play").addEventListener("click", () => play(!playing));
element("back").addEventListener("click", () => step(instants, false));
element("forth").addEventListener("click", () => step(instants, true));
element("before").addEventListener("click", () => step(decisions, false));
element("after").addEventListener("click", () => step(decisions, true));
scrub.addEventListener("input", () => seek(scrub.value / 1000));
chart.addEventListener("pointerdown", (event) => {
  const part = (event.offsetX - inset.left) / (chart.clientWidth - inset.left - inset.right);
  seek(part * end);
});
for (const box of document.querySelectorAll("[data-layer]")) box.addEventListener("change", draw);

window.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === "SELECT") return;
  const pressable = event.target.tagName === "BUTTON" || event.target.type === "checkbox";
  const faster = (by) => (speed.selectedIndex = Math.max(0, Math.min(speed.length - 1, speed.selectedIndex + by)));
  const lists = event.shiftKey ? decisions : instants;
  const actions = {
    " ": pressable ? null : () => play(!playing),
    ArrowLeft: () => step(lists, false), ArrowRight: () => step(lists, true),
    Home: () => seek(0), End: () => seek(end),
    "+": () => faster(1), "-": () => faster(-1),
  };
  if (!actions[event.key]) return;
  event.preventDefault();
  actions[event.key]();
});

function restyle() {
  readColours();
  for (const panel of panels) {
    panel.stale = true;
    paintPrior(panel);
  }
  draw();
}

scrub.max = Math.round(end * 1000);
element("trials").classList.toggle("one", trials.length === 1);
element("prior-toggle").hidden = !trials.some((trial) => trial.prior);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", restyle);
window.addEventListener("resize", draw);
window.addEventListener("hashchange", () => seek(fromAddress()));
const fromAddress = () => Number(/t=([\d.]+)/.exec(location.hash)?.[1] ?? 0);
now = Math.min(end, fromAddress());
restyle();
