
// --- coverage over time; under a deadline, how much of the graph is known; else the distance travelled ---

const chart = element("coverage");
const looks = [["ink", []], ["path", [7, 4]], ["chosen", [2, 3]]];
const inset = { left: 46, right: 16, top: 8, bottom: 26 };
const racing = trials.some((trial) => trial.deadline);
const mapping = !racing && trials.some((trial) => trial.coverage.some((percent) => percent > 0));
// One list of [time, value] a trial; what is known of a graph rises in steps.
const curves = trials.map((trial) => {
  if (!racing) return trial.time.map((t, k) => [t, (mapping ? trial.coverage : trial.distance)[k]]);
  const list = [[0, 0]];
  for (const [at, graph] of trial.graphs) {
    list.push([trial.time[at], list.at(-1)[1]], [trial.time[at], graph.vertices.length]);
  }
  list.push([trial.time.at(-1) ?? 0, list.at(-1)[1]]);
  return list;
});
const least = racing ? 4 : 1;
const highest = mapping ? 100 : curves.flat().reduce((most, [, value]) => Math.max(most, value), least);
const label = (c) => (mapping ? `${c} %` : racing ? c : `${c.toFixed(0)} m`);

// Under a deadline the clock runs to it, whether the trial does or not.
const span = Math.max(end, ...trials.map((trial) => trial.deadline ?? 0)) || 1;
const fonts = "12px system-ui, sans-serif";
let scale = null;

// Axes, curves and deadline, drawn once; the hand of the clock moves over them.
function chartGround(width, height, ratio) {
  const ground = document.createElement("canvas");
  [ground.width, ground.height] = [Math.round(width * ratio), Math.round(height * ratio)];
  const context = ground.getContext("2d");
  context.scale(ratio, ratio);
  const px = (t) => inset.left + (width - inset.left - inset.right) * t / span;
  const py = (c) => height - inset.bottom - (height - inset.top - inset.bottom) * c / highest;
  const line = (from, to, name, thick) => {
    context.strokeStyle = colour[name];
    context.lineWidth = thick;
    trace(context, [from, to], ([t, c]) => [px(t), py(c)], false);
    context.stroke();
  };
  context.font = fonts;
  context.textAlign = "right";
  for (const c of mapping ? [0, 50, 100] : [0, highest]) {
    line([0, c], [span, c], "edge", 1);
    context.fillStyle = colour.soft;
    context.fillText(label(c), inset.left - 6, py(c) + 4);
  }
  const step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000].find((s) => span / s <= width / 90) ?? 10000;
  context.textAlign = "center";
  for (let t = 0; t <= span; t += step) {
    if (px(t) < width - 24 || px(t) + 16 < width) context.fillText(`${t} s`, px(t), height - 8);
  }
  trials.forEach((trial, i) => {
    const [name, dash] = looks[i % looks.length];
    context.strokeStyle = colour[name];
    context.lineWidth = 2;
    context.setLineDash(dash);
    trace(context, curves[i], ([t, c]) => [px(t), py(c)], false);
    context.stroke();
    context.setLineDash([]);
    if (trial.deadline) line([trial.deadline, 0], [trial.deadline, highest], "chosen", 3);
  });
  const deadline = trials.find((trial) => trial.deadline)?.deadline;
  context.font = "600 " + fonts;
  context.textAlign = "right";
  if (deadline) halo(context, `deadline ${deadline.toFixed(0)} s`, px(deadline) - 6, py(0) - 6);
  return { ground, px, py, width, height, ratio, look: colour.ink };
}

function drawChart() {
  // In a frame that has no room yet there is nothing to see.
  if (!chart.clientWidth || !chart.clientHeight) return;
  const ratio = Math.min(window.devicePixelRatio || 1, 2), width = chart.clientWidth, height = chart.clientHeight;
  if (!scale || scale.width !== width || scale.ratio !== ratio || scale.look !== colour.ink) {
    [chart.width, chart.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    scale = chartGround(width, height, ratio);
  }
  const context = chart.getContext("2d"), { px, py, ground } = scale;
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, chart.width, chart.height);
  context.drawImage(ground, 0, 0);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  // What is past is shaded.
  context.fillStyle = colour.path;
  context.globalAlpha = 0.1;
  context.fillRect(px(0), inset.top, px(now) - px(0), height - inset.top - inset.bottom);
  context.globalAlpha = 1;
  trials.forEach((trial, i) => {
    const frame = frameAt(trial);
    if (frame < 0) return;
    const value = curves[i][lastAt(curves[i].length, (k) => curves[i][k][0], now + 1e-6)]?.[1] ?? 0;
    context.fillStyle = colour[looks[i % looks.length][0]];
    disc(context, [px(Math.min(now, trial.time.at(-1))), py(value)], 4.5);
    context.fill();
  });
  context.strokeStyle = context.fillStyle = colour.ink;
  context.lineWidth = 2;
  trace(context, [[now, 0], [now, highest]], ([t, c]) => [px(t), py(c)], false);
  context.stroke();
  // A handle to hold the hand by.
  disc(context, [px(now), py(0)], 7);
  context.fill();
}

// The instant at `x` px of the chart.
const instantAt = (x) => (x - inset.left) / (chart.clientWidth - inset.left - inset.right) * span;

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
