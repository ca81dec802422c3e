
// --- colours, read from the style sheet so that both schemes work ----------------------------------------

let colour = {};
function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["ink", "soft", "card", "edge", "unknown", "free", "occupied", "world", "scan", "frontier",
    "chosen", "path", "trail", "robot", "prior"]) colour[name] = style.getPropertyValue("--" + name).trim();
}
// An opaque pixel as image data hold it, seen as a 32-bit number (every platform with canvases is little-endian).
function opaque(hex) {
  const [r, g, b] = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
  return (0xff000000 | (b << 16) | (g << 8) | r) >>> 0;
}

// --- grids as pictures: one pixel a cell, rows from the top ----------------------------------------------

function picture(frame) {
  const canvas = document.createElement("canvas");
  canvas.width = Math.max(1, frame.width);
  canvas.height = Math.max(1, frame.height);
  return canvas;
}

// Paints `cells` with `pixel(kind, column, row)`; 0 is transparent.
function paint(canvas, frame, cells, pixel) {
  const context = canvas.getContext("2d");
  const image = context.createImageData(canvas.width, canvas.height);
  const pixels = new Uint32Array(image.data.buffer);
  for (let row = 0, from = 0; row < frame.height; row++) {
    let to = (frame.height - 1 - row) * frame.width;
    for (let x = 0; x < frame.width; x++) pixels[to++] = pixel(cells[from++], x, row);
  }
  context.putImageData(image, 0, 0);
}

// Brings the map of `panel` to `frame`; backwards means from the beginning. Only rows that changed are painted again.
function advanceMap(panel, frame) {
  const { trial, map, cells } = panel, { width, height } = trial.frame;
  const wanted = lastAt(trial.maps.length, (i) => trial.maps[i][0], frame);
  if (wanted === panel.applied && !panel.stale) return;
  let rows = [height, -1];
  if (wanted < panel.applied || panel.stale) rows = [0, height - 1];
  if (wanted < panel.applied) {
    cells.fill(0);
    panel.applied = -1;
  }
  while (panel.applied < wanted) {
    const [first, last] = applyRuns(trial.maps[++panel.applied][1], cells);
    if (last < first) continue;
    rows = [Math.min(rows[0], Math.floor(first / width)), Math.max(rows[1], Math.floor(last / width))];
  }
  panel.stale = false;
  if (rows[1] < rows[0]) return;
  const colours = [0, opaque(colour.free), opaque(colour.occupied)];
  panel.pixels ??= new ImageData(map.width, map.height);
  const pixels = new Uint32Array(panel.pixels.data.buffer);
  for (let row = rows[0], from = row * width; row <= rows[1]; row++) {
    let to = (height - 1 - row) * width;
    for (let x = 0; x < width; x++) pixels[to++] = colours[cells[from++]];
  }
  map.getContext("2d").putImageData(panel.pixels, 0, 0, 0, height - 1 - rows[1], width, rows[1] - rows[0] + 1);
}

function paintPrior(panel) {
  const { prior } = panel.trial;
  if (!prior) return;
  const cells = new Uint8Array(prior.frame.width * prior.frame.height);
  applyRuns(prior.cells, cells);
  const ink = opaque(colour.prior);
  panel.prior ??= picture(prior.frame);
  // Walls are solid; free space is told from nothing by sparse dots.
  paint(panel.prior, prior.frame, cells, (kind, x, y) =>
    kind === 2 || (kind === 1 && x % 4 === 0 && y % 4 === 0) ? ink : 0);
}

// --- what stands on the ground --------------------------------------------------------------------------

function trace(context, list, at, closed) {
  context.beginPath();
  list.forEach((point, i) => (i ? context.lineTo(...at(point)) : context.moveTo(...at(point))));
  if (closed) context.closePath();
}

function disc(context, [x, y], radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
}

// `pose` is where the grid's frame lies in the world.
function drawGrid(view, image, frame, [x, y, heading], opacity) {
  const { context, at, scale } = view, size = frame.resolution * scale;
  const [left, top] = [frame.origin.x * scale, -(frame.origin.y + frame.height * frame.resolution) * scale];
  context.save();
  context.translate(...at([x, y]));
  context.rotate(-heading);
  context.imageSmoothingEnabled = size < 1;
  context.globalAlpha = opacity;
  context.drawImage(image, left, top, frame.width * size, frame.height * size);
  context.restore();
}

function drawWorld({ context, at, scale }, trial) {
  context.strokeStyle = colour.world;
  context.lineWidth = 1.2;
  for (const corners of trial.polygons) {
    trace(context, corners, at, true);
    context.stroke();
  }
  for (const [x, y, radius] of trial.discs) {
    disc(context, at([x, y]), radius * scale);
    context.stroke();
  }
}

// Where the trial began, and where it was to go.
function drawEnds(view, trial) {
  const { context, at } = view;
  context.lineWidth = 2;
  const [x, y] = at([trial.x[0], trial.y[0]]);
  context.strokeStyle = colour.ink;
  disc(context, [x, y], 5);
  context.stroke();
  beside(view, "start", x, y, 6);
  if (!trial.goal) return;
  const [u, v] = at(trial.goal);
  context.beginPath();
  for (const [dx, dy] of [[0, 8], [0, -10], [12, -6], [0, -2]]) context.lineTo(u + dx, v + dy);
  context.fillStyle = colour.chosen;
  context.fill();
  context.stroke();
  beside(view, "goal", u, v, 9);
}

function drawScan({ context, at }, trial, frame) {
  const entry = latest(trial.scans, frame);
  if (!entry) return;
  const [taken, ends] = entry;
  context.fillStyle = context.strokeStyle = colour.scan;
  context.globalAlpha = 0.12;
  trace(context, [[trial.x[taken], trial.y[taken]], ...ends], at, true);
  context.fill();
  context.globalAlpha = 1;
  context.beginPath();
  for (const point of ends) {
    const [x, y] = at(point);
    context.rect(x - 1.25, y - 1.25, 2.5, 2.5);
  }
  context.fill();
}

function drawFrontiers(view, trial, decision) {
  const { context, at, scale } = view, told = [];
  const side = Math.max(3 / scale, trial.frame.resolution), [left, top] = at([0, 0]);
  if (decision.side !== side) {
    decision.side = side;
    decision.cells = new Path2D();
    for (const [x, y] of decision.frontiers.flatMap((frontier) => frontier.cells)) {
      decision.cells.rect(x - side / 2, y - side / 2, side, side);
    }
  }
  context.fillStyle = colour.frontier;
  context.save();
  context.transform(scale, 0, 0, -scale, left, top);
  context.fill(decision.cells);
  context.restore();
  // The best are drawn last, so that no worse one covers them.
  for (const i of [...decision.ranked].reverse()) {
    const frontier = decision.frontiers[i], chosen = i === decision.chosen;
    const [x, y] = at([frontier.x, frontier.y]);
    const radius = 4 + 7 * Math.max(0, Math.min(1, frontier.utility));
    context.lineWidth = 2;
    if (chosen) {
      const r = radius + 3;
      context.beginPath();
      for (const [dx, dy] of [[0, -r], [r, 0], [0, r], [-r, 0]]) context.lineTo(x + dx, y + dy);
      context.closePath();
    } else disc(context, [x, y], radius);
    context.fillStyle = chosen ? colour.chosen : colour.card;
    context.strokeStyle = chosen ? colour.ink : colour.frontier;
    context.fill();
    context.stroke();
    if (frontier.rank > 6 && !chosen) continue;
    told.unshift([`${frontier.rank}: ${frontier.utility.toFixed(2)}`, x, y, radius]);
  }
  // ... and told first; the chosen one before all.
  const chosen = decision.ranked.indexOf(decision.chosen);
  if (chosen > 0 && told[chosen]) told.unshift(...told.splice(Math.min(chosen, told.length - 1), 1));
  for (const label of told) beside(view, ...label);
}

// Where the robot was, in the world's coordinates: grown with time, made anew backwards.
function trailOf(panel, frame) {
  const { trial } = panel;
  if (!panel.trail || panel.trailed > frame) [panel.trail, panel.trailed] = [new Path2D(), -1];
  while (panel.trailed < frame) {
    const i = ++panel.trailed;
    if (i) panel.trail.lineTo(trial.x[i], trial.y[i]); else panel.trail.moveTo(trial.x[i], trial.y[i]);
  }
  return panel.trail;
}

function drawPath({ context, at, scale }, panel, frame) {
  const { trial } = panel, [left, top] = at([0, 0]);
  context.lineJoin = "round";
  context.strokeStyle = colour.trail;
  context.lineWidth = 1.5 / scale;
  context.save();
  context.transform(scale, 0, 0, -scale, left, top);
  context.stroke(trailOf(panel, frame));
  context.restore();
  const entry = latest(trial.paths, frame);
  if (!entry) return;
  context.strokeStyle = colour.path;
  context.lineWidth = 2.5;
  context.setLineDash([7, 4]);
  trace(context, entry[1], at, false);
  context.stroke();
  context.setLineDash([]);
}

function drawRobot({ context, at, scale }, trial, frame) {
  const [x, y, heading] = [trial.x[frame], trial.y[frame], trial.heading[frame]];
  const [sin, cos] = [Math.sin(heading), Math.cos(heading)];
  const placed = ([u, v]) => at([x + u * cos - v * sin, y + u * sin + v * cos]);
  let reach = 0.3;
  const size = trial.footprint.corners ? 2 * Math.max(...trial.footprint.corners.map(([u]) => u)) * scale : 8;
  if (size < 8) {
    // Of a building that is small on the screen a robot is still seen.
    disc(context, placed([0, 0]), 4.5);
    reach = 8 / scale;
  } else if (trial.footprint.corners) {
    trace(context, trial.footprint.corners, placed, true);
    reach = Math.max(reach, ...trial.footprint.corners.map(([u]) => u * 1.5));
  } else {
    const [u, v, radius] = trial.footprint.disc;
    disc(context, placed([u, v]), Math.max(4, radius * scale));
    reach = Math.max(radius * 1.5, 8 / scale);
  }
  context.fillStyle = colour.robot;
  context.strokeStyle = "#111111";
  context.lineWidth = 1.5;
  context.fill();
  context.stroke();
  context.lineWidth = 3;
  trace(context, [[0, 0], [reach, 0]], placed, false);
  context.stroke();
}

function drawScale({ context, width, height, scale }) {
  const metres = [50, 20, 10, 5, 2, 1, 0.5].find((m) => m * scale <= width / 5) ?? 0.5;
  const [x, y] = [10, height - 10];
  context.strokeStyle = colour.ink;
  context.lineWidth = 2;
  context.beginPath();
  for (const [u, v] of [[0, -6], [0, 0], [metres * scale, 0], [metres * scale, -6]]) context.lineTo(x + u, y + v);
  context.stroke();
  context.textAlign = "left";
  context.font = "12px system-ui, sans-serif";
  halo(context, `${metres} m`, x + 5, y - 6);
}
