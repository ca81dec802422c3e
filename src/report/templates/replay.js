
// --- playing ---------------------------------------------------------------------------------------------

const panels = trials.map(panelOf);
const speed = element("speed");
let pending = 0;

function draw() {
  pending = 0;
  panels.forEach(drawPanel);
  drawChart();
  element("clock").textContent = `${now.toFixed(1)} of ${end.toFixed(1)} s`;
  if (playing) return;
  chart.setAttribute("aria-valuenow", now.toFixed(1));
  chart.setAttribute("aria-valuetext", `${now.toFixed(1)} of ${end.toFixed(1)} s`);
}

// However much changes between two pictures of the screen, it is drawn once.
function changed() {
  pending ||= requestAnimationFrame(draw);
}

function seek(instant) {
  now = Math.max(0, Math.min(end, instant));
  changed();
}

function play(on) {
  playing = on && end > 0;
  element("play").textContent = playing ? "❚❚ pause" : "▶ play";
  if (!playing) return changed();
  if (now >= end) now = 0;
  last = performance.now();
  requestAnimationFrame(tick);
}

function tick(stamp) {
  if (!playing) return;
  const passed = Math.max(0, stamp - last) / 1000;
  last = stamp;
  now = Math.max(0, Math.min(end, now + passed * Number(speed.value)));
  draw();
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
// The curve is the scrubber: press or drag anywhere on it, or use the keys of a slider.
chart.addEventListener("pointerdown", (event) => {
  chart.setPointerCapture(event.pointerId);
  seek(instantAt(event.offsetX));
});
chart.addEventListener("pointermove", (event) => {
  if (chart.hasPointerCapture(event.pointerId)) seek(instantAt(event.offsetX));
});
chart.addEventListener("keydown", (event) => {
  const far = { PageUp: end / 20, PageDown: -end / 20, ArrowUp: 1, ArrowDown: -1 }[event.key];
  if (!far) return;
  event.preventDefault();
  seek(now + far);
});
for (const box of document.querySelectorAll("[data-layer]")) box.addEventListener("change", changed);

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
    fit(panel);
  }
  draw();
}

function refit() {
  panels.forEach(fit);
  scale = null;
  changed();
}

chart.setAttribute("aria-valuemax", end.toFixed(1));
document.querySelector(".stage").classList.toggle("one", trials.length === 1);
element("prior-toggle").hidden = !trials.some((trial) => trial.prior);
element("graph-toggle").hidden = !racing;
for (const layer of ["map", "scan", "frontiers"]) {
  document.querySelector(`[data-layer=${layer}]`).parentElement.hidden = !mapping;
}
const charted = racing ? "vertices known" : mapping ? "coverage" : "distance travelled";
element("chart-title").textContent = charted;
chart.setAttribute("aria-label", `Instant, on the curve of ${charted}`);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", restyle);
window.addEventListener("resize", refit);
window.addEventListener("hashchange", () => seek(fromAddress()));
const fromAddress = () => Number(/t=([\d.]+)/.exec(location.hash)?.[1] ?? 0);
now = Math.min(end, fromAddress());
restyle();
