
// --- coverage over time; under a deadline, how much of the graph is known; else the distance travelled ---

const chart = element("coverage");
const looks = [["ink", []], ["path", [7, 4]], ["chosen", [2, 3]]];
const inset = { left: 44, right: 16, top: 10, bottom: 30 };
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

function drawChart() {
  const ratio = window.devicePixelRatio || 1, width = chart.clientWidth, height = chart.clientHeight;
  chart.width = Math.round(width * ratio);
  chart.height = Math.round(height * ratio);
  const context = chart.getContext("2d");
  context.scale(ratio, ratio);
  const px = (t) => inset.left + (width - inset.left - inset.right) * t / (end || 1);
  const py = (c) => height - inset.bottom - (height - inset.top - inset.bottom) * c / highest;
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "right";
  for (const c of mapping ? [0, 50, 100] : [0, highest]) {
    context.strokeStyle = colour.edge;
    context.lineWidth = 1;
    trace(context, [[0, c], [end, c]], ([t, v]) => [px(t), py(v)], false);
    context.stroke();
    context.fillStyle = colour.soft;
    context.fillText(label(c), inset.left - 6, py(c) + 4);
  }
  const step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000].find((s) => end / s <= width / 90) ?? 10000;
  context.textAlign = "center";
  for (let t = 0; t <= end; t += step) context.fillText(`${t} s`, px(t), height - 10);
  trials.forEach((trial, i) => {
    const [name, dash] = looks[i % looks.length], stroke = colour[name], frame = frameAt(trial);
    context.strokeStyle = context.fillStyle = stroke;
    context.lineWidth = 2;
    context.setLineDash(dash);
    trace(context, curves[i], ([t, c]) => [px(t), py(c)], false);
    context.stroke();
    context.setLineDash([]);
    if (frame < 0) return;
    const value = curves[i][lastAt(curves[i].length, (k) => curves[i][k][0], now + 1e-6)]?.[1] ?? 0;
    disc(context, [px(trial.time[frame]), py(value)], 4.5);
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
  trace(context, [[now, 0], [now, highest]], ([t, c]) => [px(t), py(c)], false);
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
