// Line charts as SVG, redrawn when their box changes.

/**
 * A chart in a new element; `draw(spec)` fills it.
 *
 * spec: { x: axis, y: axis, series: [line], marks: [{ x, text }], bands: [{ y, low, high }], height }, an axis being
 * { title, log, from, to } and a line { x, y, errors, name, colour, fill, points, dashed }; values that are not finite break a line.
 */
function chart() {
  const box = el("div", { class: "chart" });
  let spec = null, width = 0;
  const redraw = () => spec && width > 0 && box.replaceChildren(legend(spec), drawn(spec, width));
  new ResizeObserver(([entry]) => {
    const now = Math.round(entry.contentRect.width);
    if (now !== width) { width = now; requestAnimationFrame(redraw); }
  }).observe(box);
  onScheme(redraw);
  return { box, draw(next) { spec = next; redraw(); } };
}

let charts = 0;

function drawn(spec, width) {
  const height = spec.height ?? 230;
  const [left, right, top, bottom] = [62, 14, 8, 40];
  const x = scale(spec.x, spec.series.flatMap((line) => [...line.x]), [left, width - right], Math.max(3, Math.floor(width / 90)));
  const bandEnds = (spec.bands ?? []).flatMap((band) => [band.low, band.high]);
  const y = scale(spec.y, [...spec.series.flatMap(withErrors), ...bandEnds], [height - bottom, top], 5, true);
  const root = svg("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": `${spec.y.title} over ${spec.x.title}` });
  root.append(svg("rect", { x: left, y: top, width: width - left - right, height: height - top - bottom, fill: "var(--plot)" }));
  for (const band of spec.bands ?? []) {
    const [low, high] = [y.at(band.low), y.at(band.high)].sort((a, b) => a - b);
    root.append(svg("rect", { x: left, y: low, width: width - left - right, height: Math.max(1, high - low), fill: "var(--accent)", opacity: 0.15 }));
  }
  // A number stays on the paper, and is left out where it would touch the one before it; a letter is 8 px wide at most.
  let free = 0;
  x.marks.forEach((mark, k) => {
    root.append(svg("line", { x1: x.at(mark), x2: x.at(mark), y1: top, y2: height - bottom, stroke: "var(--grid)" }));
    const half = 4 * x.texts[k].length, at = Math.min(x.at(mark), width - half);
    if (at - half < free) return;
    free = at + half;
    root.append(svg("text", { x: at, y: height - bottom + 16, "text-anchor": "middle" }, x.texts[k]));
  });
  y.marks.forEach((mark, k) => {
    root.append(svg("line", { x1: left, x2: width - right, y1: y.at(mark), y2: y.at(mark), stroke: "var(--grid)" }));
    root.append(svg("text", { x: left - 6, y: y.at(mark) + 4, "text-anchor": "end" }, y.texts[k]));
  });
  for (const mark of spec.marks ?? []) {
    const at = x.at(mark.x);
    if (at >= left && at <= width - right) root.append(svg("line", { x1: at, x2: at, y1: top, y2: height - bottom, stroke: "var(--soft)", "stroke-dasharray": "3 3" }));
  }
  // A line that goes beyond the axes ends at the paper's edge, where it leaves it, all its width on the paper.
  const paper = `paper-${charts++}`;
  root.append(svg("clipPath", { id: paper }, svg("rect", { x: left - 1, y: top - 1, width: width - left - right + 2, height: height - top - bottom + 2 })));
  for (const line of spec.series) root.append(...lineOf(line, x, y, top, height - bottom, paper));
  root.append(svg("text", { x: (left + width - right) / 2, y: height - 6, "text-anchor": "middle" }, spec.x.title));
  const middle = (top + height - bottom) / 2;
  root.append(svg("text", { x: 13, y: middle, "text-anchor": "middle", transform: `rotate(-90 13 ${middle})` }, spec.y.title));
  return root;
}

/** What the scale of a line has to hold: its values and the ends of their errors, as far as these leave the values legible. */
function withErrors(line) {
  const values = [...line.y].filter(Number.isFinite);
  const far = 2 * Math.max(0, ...values.map(Math.abs));
  const ends = (line.errors ?? []).flatMap((error, k) => (error > 0 ? [line.y[k] - Math.min(error, far), line.y[k] + Math.min(error, far)] : []));
  return [...values, ...ends];
}

/** Names of the lines, where there are several. */
function legend(spec) {
  const named = spec.series.filter((line) => line.name);
  const swatch = (line) => svg("svg", { width: 20, height: 8 },
    svg("line", { x1: 0, x2: 20, y1: 4, y2: 4, stroke: line.colour, "stroke-width": 3, "stroke-dasharray": line.dashed ? "4 3" : "none" }));
  return el("div", { class: "legend" }, named.length < 2 ? [] : named.map((line) => el("span", {}, swatch(line), line.name)));
}

/** Where values go on the paper. */
function scale(axis, values, [start, end], count, room = false) {
  const finite = values.filter((value) => Number.isFinite(value) && (!axis.log || value > 0));
  let from = axis.from ?? Math.min(...finite), to = axis.to ?? Math.max(...finite);
  if (!finite.length && axis.from === undefined) [from, to] = axis.log ? [1, 10] : [0, 1];
  if (axis.log) {
    if (!(to > from)) [from, to] = [from / 2, from * 2];
    if (room) [from, to] = [from / 1.3, to * 1.3];
    const span = Math.log(to / from), marks = logTicks(from, to);
    return { at: (value) => start + (end - start) * (Math.log(Math.max(value, from * 1e-3) / from) / span), marks, texts: marks.map(logText) };
  }
  if (!(to > from)) [from, to] = [from - (Math.abs(from) || 1) * 0.05, to + (Math.abs(to) || 1) * 0.05];
  const margin = room ? 0.05 * (to - from) : 0;
  if (axis.from === undefined) from -= margin;
  if (axis.to === undefined) to += margin;
  const marks = ticks(from, to, count);
  return { at: (value) => start + (end - start) * ((value - from) / (to - from)), marks, texts: tickTexts(marks) };
}

function lineOf(line, x, y, ceiling, floor, paper) {
  const made = [], pieces = [];
  let piece = [];
  for (let k = 0; k < line.x.length; k++) {
    if (Number.isFinite(line.y[k])) piece.push([x.at(line.x[k]).toFixed(1), y.at(line.y[k]).toFixed(1)]);
    else if (piece.length) { pieces.push(piece); piece = []; }
  }
  if (piece.length) pieces.push(piece);
  for (const part of pieces) {
    const path = part.map((point) => point.join(" ")).join("L");
    if (line.fill) made.push(svg("path", { d: `M${part[0][0]} ${floor}L${path}L${part[part.length - 1][0]} ${floor}Z`, fill: line.colour, opacity: 0.15 }));
    if (!line.bare) made.push(svg("path", { d: `M${path}`, "clip-path": `url(#${paper})`, fill: "none", stroke: line.colour, "stroke-width": 2, "stroke-linejoin": "round", "stroke-dasharray": line.dashed ? "5 4" : "none" }));
    if (line.points) for (const [px, py] of part) made.push(svg("circle", { cx: px, cy: py, r: 3.5, fill: line.colour }));
  }
  (line.errors ?? []).forEach((error, k) => {
    if (!(error > 0) || !Number.isFinite(line.y[k] + error)) return;
    const at = x.at(line.x[k]), within = (value) => Math.min(floor, Math.max(ceiling, y.at(value)));
    made.push(svg("line", { class: "error", x1: at, x2: at, y1: within(line.y[k] - error), y2: within(line.y[k] + error), stroke: line.colour, "stroke-width": 1.5 }));
  });
  return made;
}
