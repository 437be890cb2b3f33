// Small things that every script of the page uses.

/** An element with its attributes and children; text children become text, never markup. */
function el(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}

const SVG = "http://www.w3.org/2000/svg";
function svg(name, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/** The colour that the style sheet gives this name, light or dark. */
const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Calls back when the reader's colour scheme changes. */
function onScheme(redraw) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
}

/** Values packed by the crate: low + step * code, code 65535 being infinite. */
function unpack({ low, step, codes }) {
  const text = atob(codes);
  const values = new Float64Array(text.length / 2);
  for (let k = 0; k < values.length; k++) {
    const code = text.charCodeAt(2 * k) | (text.charCodeAt(2 * k + 1) << 8);
    values[k] = code === 65535 ? Infinity : low + step * code;
  }
  return values;
}

/** A field on a regular grid as a function of x and y, bilinear; null outside. */
function bilinear(grid, values) {
  return (x, y) => {
    const u = (x - grid.x0) / grid.dx, v = (y - grid.y0) / grid.dy;
    if (!(u >= 0 && u <= grid.nx - 1 && v >= 0 && v <= grid.ny - 1)) return null;
    const i = Math.min(Math.floor(u), Math.max(grid.nx - 2, 0)), j = Math.min(Math.floor(v), Math.max(grid.ny - 2, 0));
    const s = u - i, t = v - j;
    let sum = 0;
    for (const [di, wi] of [[0, 1 - s], [1, s]]) {
      for (const [dj, wj] of [[0, 1 - t], [1, t]]) {
        // A corner of no weight counts for nothing, be it infinite.
        if (wi * wj > 0) sum += wi * wj * values[(j + dj) * grid.nx + i + di];
      }
    }
    return sum;
  };
}

/** A number with this many significant digits and no exponent where that can be read. */
function figure(value, digits = 4) {
  if (value === null || value === undefined) return "none";
  if (!Number.isFinite(value)) return value > 0 ? "inf" : value < 0 ? "-inf" : "none";
  if (Number.isInteger(value) && Math.abs(value) < 1e7) return String(value + 0);
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -4 || size > 8) return value.toExponential(digits - 1);
  return value.toFixed(Math.max(0, digits - 1 - size));
}

/** A number as someone would have typed it. */
function plain(value) {
  if (Math.abs(value) < 1e6) return String(Number(value.toPrecision(9)));
  return value.toExponential(8).replace(/\.?0*e\+/, "e");
}

/** Metres in a unit that suits them. */
function metres(value, digits = 3) {
  const size = Math.abs(value);
  if (size >= 1) return `${figure(value, digits)} m`;
  if (size >= 1e-4) return `${figure(1e3 * value, digits)} mm`;
  return `${figure(1e6 * value, digits)} \u00b5m`;
}

/** Round positions between two ends, about `count` of them: at least three if as many are requested. */
function ticks(from, to, count) {
  const span = to - from;
  if (!(span > 0)) return [from];
  const rough = span / Math.max(count, 1), ten = 10 ** Math.floor(Math.log10(rough));
  const steps = [0.5, 1, 2, 5, 10].map((k) => k * ten);
  for (let s = steps.findIndex((step) => step >= rough * 0.999); ; s--) {
    const marks = [];
    for (let k = Math.ceil(from / steps[s] - 1e-9); k * steps[s] <= to + 1e-9 * span; k++) marks.push(k * steps[s]);
    if (marks.length >= Math.min(count, 3) || s === 0) return marks;
  }
}

/** Powers of ten between two ends, with 2 and 5 where they are few. */
function logTicks(from, to) {
  const marks = [], few = Math.log10(to / from) < 2.5;
  for (let e = Math.floor(Math.log10(from)); e <= Math.ceil(Math.log10(to)); e++) {
    for (const k of few ? [1, 2, 5] : [1]) {
      const mark = k * 10 ** e;
      if (mark >= from * 0.999 && mark <= to * 1.001) marks.push(mark);
    }
  }
  const every = Math.ceil(marks.length / 7);
  return marks.filter((_, k) => k % every === 0);
}

/** Texts of ticks, with the digits that tell them apart. */
function tickTexts(marks) {
  if (marks.length < 2) return marks.map((mark) => figure(mark, 3));
  const step = Math.min(...marks.slice(1).map((mark, k) => mark - marks[k]));
  const digits = Math.max(0, Math.min(9, -Math.floor(Math.log10(step) + 1e-9)));
  return marks.map((mark) => (Math.abs(mark) < 1e-9 * step ? "0" : mark.toFixed(digits)));
}

function logText(mark) {
  if (mark >= 1e-3 && mark < 1e6) return figure(mark, 1);
  return mark.toExponential(0).replace("e+", "e");
}

const VIRIDIS = [
  [68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141],
  [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37],
];
/** Colour of t in 0..1 as [r, g, b] of 255. */
function viridis(t) {
  const at = Math.min(Math.max(t, 0), 1) * (VIRIDIS.length - 1), k = Math.min(Math.floor(at), VIRIDIS.length - 2);
  return [0, 1, 2].map((c) => Math.round(VIRIDIS[k][c] + (at - k) * (VIRIDIS[k + 1][c] - VIRIDIS[k][c])));
}

/** A table of rows of cells; numbers are set right. */
function table(head, rows) {
  const cell = (name) => (value) => {
    const number = typeof value === "number";
    return el(name, { class: number || (typeof value === "string" && /^([-\d.]|inf$)/.test(value)) ? "n" : null }, number ? figure(value) : value ?? "");
  };
  const numeric = head.map((_, k) => rows.length > 0 && rows.every((row) => typeof row[k] === "number" || /^([-\d.]|inf$)/.test(row[k] ?? "")));
  return el("div", { class: "scroll" }, el("table", {},
    el("thead", {}, el("tr", {}, head.map((text, k) => el("th", { class: numeric[k] ? "n" : null }, text)))),
    el("tbody", {}, rows.map((row) => el("tr", {}, row.map(cell("td")))))));
}

/** A table of a case's keys, as [name, value] pairs of what is nested in `tables`, and `more` of them. */
function caseOf(tables, more = []) {
  const said = (value) => (typeof value === "number" ? plain(value) : Array.isArray(value) ? value.map(said).join("; ")
    : value !== null && typeof value === "object" ? Object.entries(value).map(([key, inner]) => `${key} ${said(inner)}`).join(", ") : String(value));
  const flat = (value, name) => (value !== null && typeof value === "object" && !Array.isArray(value)
    ? Object.entries(value).flatMap(([key, inner]) => flat(inner, name ? `${name}.${key}` : key)) : [[name, value]]);
  const row = ([name, value]) => el("tr", {}, el("th", {}, name), el("td", { class: "text" }, said(value)));
  return el("div", { class: "scroll" }, el("table", {}, el("tbody", {}, [...flat(tables ?? {}, ""), ...more].map(row))));
}

/** A titled box of the page. */
const panel = (title, ...children) => el("section", { class: "panel" }, title ? el("h2", {}, title) : null, ...children);

/** Up to `most` places spread over a list, both ends among them. */
function few(list, most) {
  const count = Math.min(most, list.length);
  return [...new Set(Array.from({ length: count }, (_, k) => Math.round(k * (list.length - 1) / Math.max(count - 1, 1))))];
}

/** The headline figures, [value, name] each. */
const figures = (pairs) => pairs.map(([value, name]) => el("li", {}, el("b", {}, value), el("span", {}, name)));

/** What stands in the page for its scripts. */
const pageData = () => JSON.parse(document.getElementById("data").textContent);
