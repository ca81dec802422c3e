
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
const chosenAt = (trial) => (trial.deadline ? trial.graphs : trial.decisions).map(([at]) => trial.time[at]);
const decisions = merged(trials.map(chosenAt));
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
// Before its first frame a robot stands where it begins.
const frameAt = (trial) =>
  Math.max(lastAt(trial.time.length, (i) => trial.time[i], now + 1e-6), Math.min(0, trial.time.length - 1));
const latest = (list, frame) => list[lastAt(list.length, (i) => list[i][0], frame)];

// --- one panel per trial ---------------------------------------------------------------------------------

function panelOf(trial) {
  const section = make("section", "card trial");
  section.setAttribute("aria-label", trial.name);
  const side = make("section", "card trial side");
  side.setAttribute("aria-label", `${trial.name}, in words`);
  const canvas = make("canvas");
  canvas.setAttribute("role", "img");
  canvas.tabIndex = 0;
  const status = make("p", "now");
  const scroll = make("div", "scroll"), table = make("table", "decision"), events = make("ul", "events");
  const policy = make("table", "decision");
  // Scrolled by keyboard too, where the tables are wider than the screen.
  Object.entries({ tabindex: 0, role: "region", "aria-label": `What ${trial.name} chose among` })
    .forEach(([name, value]) => scroll.setAttribute(name, value));
  scroll.append(table, policy);
  side.append(status, scroll, events);
  const heading = make("h2", "", trial.outcome ? `${trial.name}: ${trial.outcome.replaceAll("-", " ")}` : trial.name);
  if (trials.length > 1) heading.prepend(swatch(trials.indexOf(trial)));
  const top = make("div", "top");
  const cells = new Uint8Array(trial.frame.width * trial.frame.height);
  const map = picture(trial.frame);
  const panel = { trial, canvas, status, table, policy, events, cells, map, applied: -1, stale: true };
  top.append(heading, zoomButtons(panel));
  if (trials.length > 1) side.prepend(make("h3", "", trial.name));
  section.append(top, canvas);
  element("trials").append(section);
  element("sides").append(side);
  handle(panel);
  return panel;
}

const boxes = [...document.querySelectorAll("[data-layer]")];
const layers = Object.fromEntries(boxes.map((box) => [box.dataset.layer, box]));

// What changes seldom: map, prior and walls, drawn once for as long as they and the view of them stay.
function groundOf(panel, view, frame) {
  const { trial } = panel, shown = (name) => layers[name].checked;
  if (shown("map")) advanceMap(panel, frame);
  const state = [panel.applied, view.lens, shown("map"), shown("prior"), shown("world"), colour.free].join();
  if (panel.ground && panel.stands === state) return panel.ground;
  panel.stands = state;
  if (!panel.ground) {
    panel.ground = document.createElement("canvas");
    [panel.ground.width, panel.ground.height] = [panel.canvas.width, panel.canvas.height];
  }
  const context = panel.ground.getContext("2d"), over = { ...view, context };
  context.setTransform(view.ratio, 0, 0, view.ratio, 0, 0);
  // Without a map there is nothing unknown to show.
  context.fillStyle = mapping ? colour.unknown : colour.free;
  context.fillRect(0, 0, view.width, view.height);
  if (shown("map")) drawGrid(over, panel.map, trial.frame, trial.pose, 1);
  if (shown("prior") && panel.prior) drawGrid(over, panel.prior, trial.prior.frame, [0, 0, 0], 0.6);
  if (shown("world")) drawWorld(over, trial);
  drawScale(over);
  return panel.ground;
}

function drawPanel(panel) {
  const { trial } = panel, frame = frameAt(trial), view = viewOf(panel, panel.canvas.getContext("2d"));
  const { context } = view, shown = (name) => layers[name].checked;
  const over = now >= (trial.time.at(-1) ?? 0);
  const state = [frame, over, view.lens, colour.free, ...Object.values(layers).map((box) => box.checked)].join();
  if (panel.drawn === state) return;
  panel.drawn = state;
  const decision = latest(trial.decisions, frame), graph = latest(trial.graphs, frame);
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.drawImage(groundOf(panel, view, frame), 0, 0);
  context.setTransform(view.ratio, 0, 0, view.ratio, 0, 0);
  if (frame >= 0) {
    if (shown("scan")) drawScan(view, trial, frame);
    if (shown("path")) drawPath(view, panel, frame);
    if (shown("frontiers") && decision) drawFrontiers(view, trial, decision[1]);
    if (shown("graph") && graph) drawGraph(view, graph[1]);
    drawEnds(view, trial);
    placeLabels(view);
    drawRobot(view, trial, frame);
  }
  tell(panel, frame, decision, graph);
}

// --- the side panel --------------------------------------------------------------------------------------

function tell(panel, frame, decision, graph) {
  const { trial } = panel;
  let text = "not begun";
  if (frame >= 0) {
    const [time, distance, coverage] = [trial.time[frame], trial.distance[frame], trial.coverage[frame]];
    const ended = now >= trial.time.at(-1) ? ` · ended: ${(trial.outcome || "over").replaceAll("-", " ")}` : "";
    const parts = [`${time.toFixed(1)} s`, `${distance.toFixed(2)} m`];
    if (trial.deadline) parts.push(graphStatus(trial, graph?.[1], time));
    else if (mapping) parts.push(`${coverage.toFixed(1)} % covered`);
    text = `${parts.join(" · ")}${ended}`;
  }
  panel.status.textContent = text;
  // Those who hear the page are told of instants where it stands still.
  if (!playing) panel.canvas.setAttribute("aria-label", `${trial.name}: map, frontiers, path and robot; ${text}`);
  if (panel.decision !== decision) {
    panel.decision = decision;
    panel.table.replaceChildren(...(decision ? decisionRows(trial, decision) : []));
  }
  if (panel.graph !== graph) {
    panel.graph = graph;
    panel.table.replaceChildren(...(graph ? candidateRows(trial, graph) : []));
    panel.policy.replaceChildren(...(graph ? policyRows(trial, graph) : []));
  }
  const count = lastAt(trial.events.length, (i) => trial.events[i][0], frame) + 1;
  if (panel.told !== count) {
    panel.told = count;
    const recent = trial.events.slice(Math.max(0, count - 4), count).reverse();
    panel.events.replaceChildren(...recent.map(([at, event]) =>
      make("li", "", `${trial.time[at].toFixed(1)} s  ${event}`)));
  }
}

function row(cells, name, className = "") {
  const line = make("tr", className);
  line.append(...cells.map((text) => make(name, "", text)));
  return line;
}

// What was chosen among, best first, and by which rule.
function decisionRows(trial, [at, decision]) {
  const MOST = 8;
  const when = `decision at ${trial.time[at].toFixed(1)} s`;
  if (!decision.frontiers.length) return [make("caption", "", `${when}: no frontier is left`)];
  const because = trial.rule ? ` · why: ${trial.rule}` : "";
  const rows = [make("caption", "", `${when}: distance D, gain I, utility u${because}`),
    row(["rank", "D (m)", "d", "I (m²)", "i", "u"], "th")];
  const most = (of) => Math.max(...decision.frontiers.map(of));
  const [far, rich] = [most((f) => f.distance), most((f) => f.gain)];
  const share = (part, whole, none) => (whole > 0 ? part / whole : none).toFixed(2);
  for (const i of decision.ranked) {
    const { rank, distance, gain, utility } = decision.frontiers[i], chosen = i === decision.chosen;
    if (rank > MOST && !chosen) continue;
    const numbers = [distance.toFixed(2), share(far - distance, far, 1), gain.toFixed(2), share(gain, rich, 0),
      utility.toFixed(3)];
    rows.push(row([`${chosen ? "◆ " : ""}${rank}`, ...numbers], "td", chosen ? "chosen" : ""));
  }
  const more = decision.frontiers.length - rows.length + 2;
  if (more > 0) rows.push(row(["", `and ${more} more`, "", "", "", ""], "td", "soft"));
  return rows;
}
