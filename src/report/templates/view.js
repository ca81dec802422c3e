
// --- a view of one trial: zoom, pan, and labels that do not touch ------------------------------------------

// Trials of one building are looked at through one lens: [zoom, x and y of the middle (m)].
const lenses = new Map();
const MOST = 40;
function lensOf({ view }) {
  const name = view.join();
  if (!lenses.has(name)) lenses.set(name, { zoom: 1, x: (view[0] + view[2]) / 2, y: (view[1] + view[3]) / 2 });
  return lenses.get(name);
}

// How high a map may be so that it, the scrubber and the controls are on one screen.
function room() {
  const top = element("trials").querySelector("canvas").getBoundingClientRect().top + window.scrollY;
  const height = (name) => document.querySelector(name).offsetHeight;
  const legend = window.innerWidth > 900 ? height(".layers") : 0;
  return window.innerHeight - Math.min(top, 260) - height(".scrubber") - legend - 40;
}

// Sizes the canvas to its column and the world's shape: when the window changes, not at every instant.
function fit(panel) {
  const { canvas, trial: { view: [x0, y0, x1, y1] } } = panel;
  const ratio = Math.min(window.devicePixelRatio || 1, 2), width = canvas.clientWidth;
  const height = Math.round(Math.max(170, Math.min(width * (y1 - y0) / (x1 - x0), room())));
  canvas.style.height = height + "px";
  // In a frame that has no room yet there is nothing to see, and a canvas of no width cannot be drawn.
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = Math.round(height * ratio);
  panel.size = { width, height, ratio, scale: Math.min(width / (x1 - x0), height / (y1 - y0)) };
  panel.ground = panel.drawn = null;
}

// The transform from the world to the canvas of `panel`, and the labels to be put there.
function viewOf(panel, context) {
  const { width, height, ratio, scale: whole } = panel.size, lens = lensOf(panel.trial);
  const scale = whole * lens.zoom;
  const at = ([x, y]) => [width / 2 + (x - lens.x) * scale, height / 2 - (y - lens.y) * scale];
  return { context, width, height, ratio, scale, at, labels: [], lens: `${lens.zoom},${lens.x},${lens.y}` };
}

// Keeps the middle within the building.
function look(panel, zoom, x, y) {
  const lens = lensOf(panel.trial), [x0, y0, x1, y1] = panel.trial.view;
  const within = (value, low, high) => {
    const slack = (high - low) * (1 - 1 / zoom) / 2, middle = (low + high) / 2;
    return Math.max(middle - slack, Math.min(middle + slack, value));
  };
  lens.zoom = Math.max(1, Math.min(MOST, zoom));
  lens.x = lens.zoom === 1 ? (x0 + x1) / 2 : within(x, x0, x1);
  lens.y = lens.zoom === 1 ? (y0 + y1) / 2 : within(y, y0, y1);
  for (const other of panels) other.canvas.classList.toggle("zoomed", lensOf(other.trial).zoom > 1);
  changed();
}

// Zooms by `factor`, the point at (u, v) px standing still.
function zoomAt(panel, factor, u = panel.size.width / 2, v = panel.size.height / 2) {
  const lens = lensOf(panel.trial), { width, height, scale } = panel.size;
  const zoom = Math.max(1, Math.min(MOST, lens.zoom * factor));
  const shift = (1 / (scale * lens.zoom) - 1 / (scale * zoom));
  look(panel, zoom, lens.x + (u - width / 2) * shift, lens.y - (v - height / 2) * shift);
}
function moveBy(panel, dx, dy) {
  const lens = lensOf(panel.trial), scale = panel.size.scale * lens.zoom;
  look(panel, lens.zoom, lens.x - dx / scale, lens.y + dy / scale);
}

// Wheel, drag, pinch, and keys while the map has the focus.
function handle(panel) {
  const { canvas } = panel, held = new Map();
  const middle = () => [...held.values()].reduce(([x, y], [u, v]) => [x + u / held.size, y + v / held.size], [0, 0]);
  const apart = () => {
    const [[x, y], [u, v]] = held.values();
    return Math.hypot(u - x, v - y) || 1;
  };
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoomAt(panel, Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.002)), event.offsetX, event.offsetY);
  }, { passive: false });
  canvas.addEventListener("pointerdown", (event) => {
    held.set(event.pointerId, [event.offsetX, event.offsetY]);
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!held.has(event.pointerId)) return;
    const from = middle(), wide = held.size > 1 ? apart() : 1;
    held.set(event.pointerId, [event.offsetX, event.offsetY]);
    const to = middle();
    if (held.size > 1) zoomAt(panel, apart() / wide, ...to);
    moveBy(panel, to[0] - from[0], to[1] - from[1]);
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => held.delete(event.pointerId));
  }
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60] }[event.key];
    const factor = { "+": 1.5, "=": 1.5, "-": 1 / 1.5 }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey || !(step || factor || event.key === "0")) return;
    event.preventDefault();
    event.stopPropagation();
    if (step) moveBy(panel, ...step); else if (factor) zoomAt(panel, factor); else look(panel, 1, 0, 0);
  });
}

function zoomButtons(panel) {
  const group = make("span", "zoom");
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", "Zoom");
  const acts = [["−", "Zoom out", () => zoomAt(panel, 1 / 1.5)], ["+", "Zoom in", () => zoomAt(panel, 1.5)],
    ["whole", "Show the whole building", () => look(panel, 1, 0, 0)]];
  for (const [text, name, act] of acts) {
    const button = make("button", "", text);
    button.type = "button";
    button.title = name;
    if (text.length < 2) button.setAttribute("aria-label", name);
    button.addEventListener("click", act);
    group.append(button);
  }
  return group;
}

// --- labels ----------------------------------------------------------------------------------------------

const widths = new Map();
function widthOf(context, text) {
  if (!widths.has(text)) widths.set(text, context.measureText(text).width);
  return widths.get(text);
}

// Remembers that `text` belongs beside what is drawn at (x, y) with this radius; the first ones find room first.
function beside(view, text, x, y, radius) {
  view.labels.push({ text, x, y, radius });
}

// Writes every label on the first side of its mark that is free; one that finds none is left out.
function placeLabels(view) {
  const { context, labels, width, height } = view, taken = [[6, height - 34, 6 + width / 4, height]];
  const hits = ([a, b, c, d]) => taken.some(([e, f, g, h]) => a < g && e < c && b < h && f < d);
  context.font = "600 12px system-ui, sans-serif";
  context.textAlign = "left";
  for (const { x, y, radius } of labels) taken.push([x - radius, y - radius, x + radius, y + radius]);
  for (const { text, x, y, radius } of labels) {
    const wide = widthOf(context, text), gap = radius + 5;
    const sides = [[gap, 4], [-gap - wide, 4], [-wide / 2, -gap], [-wide / 2, gap + 9],
      [gap - 2, -gap + 4], [gap - 2, gap + 6], [-gap - wide + 2, -gap + 4], [-gap - wide + 2, gap + 6]];
    for (const [dx, dy] of sides) {
      const box = [x + dx - 2, y + dy - 11, x + dx + wide + 2, y + dy + 3];
      if (box[0] < 0 || box[1] < 0 || box[2] > width || box[3] > height || hits(box)) continue;
      taken.push(box);
      halo(context, text, x + dx, y + dy);
      break;
    }
  }
}

// Text that can be read on any ground.
function halo(context, text, x, y) {
  context.lineJoin = "round";
  context.lineWidth = 4;
  context.strokeStyle = colour.card;
  context.strokeText(text, x, y);
  context.fillStyle = colour.ink;
  context.fillText(text, x, y);
}
