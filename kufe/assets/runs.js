// The page of recorded runs.
//
// Data: { index, rate_hz, model, channels: [{ key, label, unit, times }], runs: [{ run, track, driver, session, t0_s, rate_hz,
// columns: { key: packed }, model: { key: packed }, stretches: [{ column, kind, from_s, to_s }], sections: [{ column, from_m, to_m, lost_s }],
// contacts: [[from_s, to_s]], faults: [{ columns, proven, looks_like, evidence }],
// notes: [{ column, what }] }], left_out: [[run, reason]] }. The address may state what is
// shown: #run=NAME&run=NAME&channel=KEY&over=time&from=10&to=20; track=NAME without a run shows the quickest runs of a track.

const LEFT = 58, RIGHT = 10, TALL = 132, BAR = 62;
/** Channels that are shown at first, and runs. */
const CHANNELS_AT_FIRST = 6, RUNS_AT_FIRST = 4;
/** More lines than these have no value each at the cursor, and no dashes. */
const FEW_LINES = 6;
/** Time in which plots are drawn in a frame [ms]; the others follow in the next. */
const FRAME = 14;
const DELTA = { key: "@delta", label: "time behind the reference", unit: "s", times: 1 };
const EVENTS = {
  gap: ["gap", "--steel"], saturated: ["at its stop", "--second"], leap: ["leap", "--fourth"], "drop-out": ["drop-out", "--ink"], still: ["one value", "--third"],
  contact: ["pushed from outside", "--warn-line"], section: ["run and model differ", "--accent"],
};

/** Places that do not decrease: what is searched in. */
function ordered(values) {
  const places = Float64Array.from(values);
  let most = places.find(Number.isFinite) ?? 0;
  for (let i = 0; i < places.length; i++) {
    if (places[i] > most) most = places[i];
    places[i] = most;
  }
  return places;
}

function runsPage(main, data) {
  const runs = data.runs.map((run) => {
    const place = ordered(unpack(run.columns.s_m).map((value) => (Number.isFinite(value) ? value : NaN)));
    return { ...run, place, count: place.length, seconds: (place.length - 1) / run.rate_hz };
  });
  const channelOf = new Map([...data.channels, DELTA].map((channel) => [channel.key, channel]));
  const tracks = [...new Set(runs.map((run) => run.track))];
  const address = new URLSearchParams(location.hash.slice(1));
  const named = (name) => runs.find((run) => run.run === name);
  const requested = address.getAll("run").map(named).filter(Boolean);
  const quickest = (list) => list.reduce((best, run) => (run.seconds < best.seconds ? run : best));
  const { track } = requested[0] ?? runs.find((run) => address.has("track") && run.track === address.get("track")) ?? runs[0];
  const onFirst = runs.filter((run) => run.track === track);
  const first = requested[0] ?? quickest(onFirst);
  const state = {
    reference: first, shown: new Set(requested.length > 0 ? requested : [first, ...onFirst.filter((run) => run !== first).slice(0, RUNS_AT_FIRST - 1)]), over: address.get("over") === "time" ? "t" : "s",
    against: "nothing", from: 0, to: 1, cursor: null,
    channels: new Set(data.channels.filter((channel) => channel.key !== "s_m").slice(0, CHANNELS_AT_FIRST).map((channel) => channel.key)),
  };
  // A channel that the address states comes first.
  const linked = address.getAll("channel").filter((key) => data.channels.some((channel) => channel.key === key));
  data.channels.sort((a, b) => linked.includes(b.key) - linked.includes(a.key));
  for (const key of linked) state.channels.add(key);
  if (data.model) state.channels.add("behind_s");

  // Values: unpacked when they are first drawn, in the shown unit.
  const cache = new Map();
  function cached(name, make) {
    if (!cache.has(name)) cache.set(name, make());
    return cache.get(name);
  }
  const numbers = (packed, key) => packed && unpack(packed).map((value) => (Number.isFinite(value) ? channelOf.get(key).times * value : NaN));
  const measured = (run, key) => cached(`${run.run}\n${key}`, () => numbers(run.columns[key] ?? (key === "behind_s" ? run.model[key] : null), key));
  const modelled = (run, key) => cached(`${run.run}\n${key}\nmodel`, () => numbers(key === "behind_s" ? null : run.model[key], key));
  const xOf = (run, i) => (state.over === "t" ? i / run.rate_hz : run.place[i]);

  /** The last sample at or before a place of the axis. */
  function before(run, x) {
    if (state.over === "t") return Math.min(Math.max(Math.floor(x * run.rate_hz), 0), run.count - 1);
    let [low, high] = [0, run.count - 1];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (run.place[middle] <= x) low = middle; else high = middle - 1;
    }
    return low;
  }
  /** The place of x among the samples, a number with a fraction; NaN outside the run. */
  function position(run, x) {
    if (!(x >= xOf(run, 0) && x <= xOf(run, run.count - 1))) return NaN;
    const i = before(run, x), step = i + 1 < run.count ? xOf(run, i + 1) - xOf(run, i) : 0;
    return step > 0 ? i + (x - xOf(run, i)) / step : i;
  }
  function valueAt(run, values, x) {
    const at = position(run, x), i = Math.floor(at);
    return Number.isNaN(at) ? NaN : at === i ? values[i] : values[i] + (at - i) * (values[i + 1] - values[i]);
  }

  /** The time by which a run comes later than the reference, zero at the first place of both. */
  const behind = (run) => cached(`${run.run}\n@delta\n${state.reference.run}`, () => {
    const late = new Float64Array(run.count), reference = state.reference;
    let first = NaN;
    for (let i = 0; i < run.count; i++) {
      late[i] = i / run.rate_hz - position(reference, run.place[i]) / reference.rate_hz;
      if (Number.isNaN(first)) first = late[i];
    }
    return late.map((value) => value - first);
  });

  /** The values of a run in a plot; null where it has none. */
  function lineOf(run, key) {
    if (key === DELTA.key) return run === state.reference ? null : behind(run);
    const values = measured(run, key);
    if (!values) return null;
    if (state.against === "model" && key !== "behind_s") {
      const model = modelled(run, key);
      return model && cached(`${run.run}\n${key}\nresidual`, () => values.map((value, i) => value - model[i]));
    }
    if (state.against === "reference") {
      const others = run !== state.reference && measured(state.reference, key);
      return others ? cached(`${run.run}\n${key}\n${state.reference.run}\n${state.over}`, () => values.map((value, i) => value - valueAt(state.reference, others, xOf(run, i)))) : null;
    }
    return values;
  }

  let scheme = {};
  function readScheme() {
    for (const name of ["ink", "soft", "grid", "plot", "accent", "second", "third", "fourth", "steel", "warn-line"]) scheme[`--${name}`] = ink(name);
  }
  const listed = () => runs.filter((run) => state.shown.has(run));
  function colourOf(run) {
    if (run === state.reference) return scheme["--ink"];
    const palette = ["--accent", "--second", "--third", "--fourth"], k = listed().filter((one) => one !== state.reference).indexOf(run);
    return k < palette.length && state.shown.size <= palette.length + 1 ? scheme[palette[k]] : `hsl(${Math.round(137.5 * k) % 360} 60% 50%)`;
  }
  function linesOf(key) {
    const lines = [], alone = state.shown.size === 1;
    for (const run of listed()) {
      const values = lineOf(run, key), colour = colourOf(run);
      if (values) lines.push({ run, values, colour, name: run.run });
      const model = state.against === "nothing" && key !== DELTA.key && modelled(run, key);
      if (model && state.shown.size <= FEW_LINES) lines.push({ run, values: model, colour: alone ? scheme["--second"] : colour, name: alone ? "model" : `${run.run}, model`, dashed: true });
    }
    // The reference lies on top.
    return lines.sort((a, b) => (a.run === state.reference) - (b.run === state.reference));
  }

  // The page.
  const host = el("div", { class: "plots", tabindex: 0, "aria-label": "channels" }), list = el("div", { class: "list" }), findings = el("section", { class: "panel" });
  const bar = el("canvas", { class: "range", "aria-label": "the whole run, and the part of it that is shown" });
  const readout = el("span", { class: "readout" });
  const select = (name, options, set) => el("label", {}, name, el("select", { onchange: (event) => { set(event.target.value); } }, options.map(([value, text, chosen]) => el("option", { value, selected: chosen === true }, text))));
  const button = (text, does, title) => el("button", { type: "button", class: "button", title, onclick: does }, text);
  const times = runs.map((run) => run.seconds), [least, most] = [Math.min(...times), Math.max(...times)];
  const proven = runs.filter((run) => run.faults.some((fault) => fault.proven)).length + data.left_out.length;
  main.replaceChildren(
    el("header", {}, el("h1", {}, `${runs.length} ${runs.length === 1 ? "run" : "runs"} on ${tracks.map((track) => track ?? "a track without a name").join(", ")}`), el("p", { class: "soft" }, [data.index, data.model && `model ${data.model}`].filter(Boolean).join("; "))),
    el("ul", { class: "figures" }, figures([
      [least === most ? `${figure(least)} s` : `${figure(least)} to ${figure(most)} s`, "length"],
      [`${figure(Math.max(...runs.map((run) => run.place[run.count - 1] - run.place[0])))} m`, "longest distance"],
      ...(proven > 0 ? [[String(proven), "provably wrong"]] : []),
    ])),
    ...data.left_out.map(([run, reason]) => el("p", { class: "warning" }, `${run}: ${reason}`)),
    el("div", { class: "viewer" }, list, el("div", { class: "views" },
      el("div", { class: "tools" },
        select("over", [["s", "distance", state.over === "s"], ["t", "time", state.over === "t"]], (value) => { state.over = value; whole(); redraw(true); }),
        select("less", [["nothing", "nothing", true], ["reference", "the reference"], ...(data.model ? [["model", "the model"]] : [])], (value) => { state.against = value; redraw(true); }),
        button("\u2212", () => zoom(1.6), "smaller scale"), button("+", () => zoom(1 / 1.6), "larger scale"), button("\u25c0", () => pan(-0.25), "back"), button("\u25b6", () => pan(0.25), "on"), button("whole", () => { whole(); redraw(); }, "the whole run")),
      el("details", { class: "channels" }, el("summary", {}, `${data.channels.length} channels at ${plain(data.rate_hz)} Hz: choice and resolution`), channelTable()),
      el("div", { class: "sticky" }, bar, readout), host, findings)),
  );

  /** Every channel with its resolution: half a step of its packed values. */
  function channelTable() {
    const row = ({ key, label, unit, times: factor }) => {
      const steps = runs.flatMap((run) => [run.columns[key], run.model[key]]).filter(Boolean).map((packed) => packed.step);
      const box = el("input", { type: "checkbox", checked: state.channels.has(key), onchange: (event) => { if (event.target.checked) state.channels.add(key); else state.channels.delete(key); redraw(true); } });
      return el("tr", {}, el("td", {}, el("label", {}, box, ` ${label}`)), el("td", {}, key), el("td", {}, `\u00b1 ${figure(0.5 * factor * Math.max(...steps), 2)} ${unit}`));
    };
    return el("div", { class: "scroll" }, el("table", {}, el("thead", {}, el("tr", {}, ["channel", "column", "resolution"].map((text) => el("th", {}, text)))), el("tbody", {}, data.channels.map(row))));
  }

  /** The runs of each track, with marks of what is shown. */
  function fillList() {
    const row = (run) => {
      const box = el("input", { type: "checkbox", checked: state.shown.has(run), "aria-label": `show ${run.run}`, onchange: (event) => { if (event.target.checked) state.shown.add(run); else state.shown.delete(run); redraw(true); } });
      const reference = el("input", { type: "radio", name: "reference", checked: run === state.reference, title: "the reference", "aria-label": `${run.run} as reference`, onchange: () => { state.reference = run; state.shown.add(run); redraw(true); } });
      const swatch = el("span", { class: "swatch", style: state.shown.has(run) ? `background:${colourOf(run)}` : null });
      const faults = run.faults.length > 0 ? el("b", { class: "bad", title: run.faults.map((fault) => `${fault.columns.join(", ")}: ${fault.looks_like}: ${fault.evidence}`).join("\n") }, "!") : null;
      return el("div", { class: "run" }, el("label", {}, box, swatch, el("span", { class: "name" }, run.run), faults), el("span", { class: "soft" }, [run.driver, `${figure(run.seconds)} s`].filter(Boolean).join(", ")), reference);
    };
    const at = list.scrollTop;
    list.replaceChildren(...tracks.flatMap((track) => {
      const here = runs.filter((run) => run.track === track);
      const every = button("all", () => { state.shown = new Set(here); if (state.reference.track !== track) state.reference = quickest(here); whole(); redraw(true); }, "show every run of this track");
      const one = button("one", () => { state.shown = new Set([here.includes(state.reference) ? state.reference : quickest(here)]); [state.reference] = state.shown; whole(); redraw(true); }, "show one run of this track");
      return [el("h2", {}, track ?? "runs", every, one), ...here.map(row)];
    }), el("p", { class: "soft" }, "The dot on the right selects the reference."));
    list.scrollTop = at;
  }

  // Plots: drawn when they are on the screen, as many in a frame as there is time for.
  let width = 0, plots = [], queue = new Set(), waiting = false;
  const onScreen = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      const plot = plots.find((one) => one.canvas === entry.target);
      if (!plot) continue;
      plot.visible = entry.isIntersecting;
      if (plot.visible && plot.stale) wait();
    }
  }, { rootMargin: "200px" });
  function wait() {
    if (!waiting) requestAnimationFrame(frame);
    waiting = true;
  }
  function frame() {
    waiting = false;
    const begun = performance.now();
    if (queue.delete(bar)) paintBar();
    for (const plot of plots) {
      if (!plot.stale || !plot.visible) continue;
      if (performance.now() - begun > FRAME) { wait(); return; }
      plot.stale = false;
      if (plot.channel) paint(plot); else paintEvents(plot);
    }
    read();
  }
  function redraw(afresh = false) {
    if (width === 0) return;
    if (afresh) { fillList(); fillFindings(); fillPlots(); }
    for (const plot of plots) plot.stale = true;
    queue.add(bar);
    wait();
  }
  function fillPlots() {
    onScreen.disconnect();
    const delta = state.over === "s" && state.shown.size > 1 ? [DELTA] : [];
    const rows = [null, ...delta, ...data.channels.filter((channel) => state.channels.has(channel.key))];
    plots = rows.map((channel) => {
      const canvas = el("canvas"), values = el("span", { class: "values" });
      const of = channel ? listed().filter((run) => run.faults.some((fault) => fault.columns.includes(channel.key))) : [];
      const title = channel ? `${channel.label}${state.against === "nothing" || channel === DELTA ? "" : state.against === "model" ? ", run less model" : ", run less reference"} [${channel.unit}]` : "events";
      const bad = of.length > 0 ? el("b", { class: "bad" }, ` fault: ${of.map((run) => run.run).join(", ")}`) : null;
      const box = el("div", { class: "one" }, el("div", { class: "head" }, el("span", { class: "title" }, title, bad), values), canvas);
      return { channel, canvas, values, box, stale: true, visible: false, tall: channel ? TALL : Math.min(300, 14 + 11 * state.shown.size) };
    });
    host.replaceChildren(...plots.map((plot) => plot.box));
    for (const plot of plots) { size(plot.canvas, plot.tall); onScreen.observe(plot.canvas); }
  }
  function size(canvas, tall) {
    const ratio = Math.min(devicePixelRatio || 1, 2);
    canvas.style.height = `${tall}px`;
    [canvas.width, canvas.height] = [Math.round(ratio * width), Math.round(ratio * tall)];
  }
  function pen(canvas, tall) {
    const made = canvas.getContext("2d"), ratio = canvas.width / width;
    made.setTransform(ratio, 0, 0, ratio, 0, 0);
    made.clearRect(0, 0, width, tall);
    made.font = "11px system-ui, sans-serif";
    return made;
  }
  const inner = () => width - LEFT - RIGHT;
  const toX = (x) => LEFT + inner() * (x - state.from) / (state.to - state.from);
  const fromX = (pixel) => state.from + (state.to - state.from) * (pixel - LEFT) / inner();

  function paint({ channel, canvas, tall }) {
    const draw = pen(canvas, tall), lines = linesOf(channel.key);
    let [low, high] = [Infinity, -Infinity];
    for (const { run, values } of lines) {
      const last = Math.min(before(run, state.to) + 1, run.count - 1);
      for (let i = before(run, state.from); i <= last; i++) {
        const value = values[i];
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    if (!(high > low)) [low, high] = Number.isFinite(low) ? [low - (Math.abs(low) || 1) * 0.05, low + (Math.abs(low) || 1) * 0.05] : [0, 1];
    const [top, floor] = [6, tall - 6], y = (value) => floor - (floor - top) * (value - low) / (high - low);
    draw.strokeStyle = scheme["--grid"];
    draw.fillStyle = scheme["--soft"];
    draw.lineWidth = 1;
    draw.beginPath();
    for (const mark of ticks(state.from, state.to, Math.max(3, width / 110))) { draw.moveTo(Math.round(toX(mark)) + 0.5, 0); draw.lineTo(Math.round(toX(mark)) + 0.5, tall); }
    const marks = ticks(low, high, 3), texts = tickTexts(marks);
    draw.textAlign = "right";
    draw.textBaseline = "middle";
    marks.forEach((mark, k) => { draw.moveTo(LEFT, Math.round(y(mark)) + 0.5); draw.lineTo(width - RIGHT, Math.round(y(mark)) + 0.5); draw.fillText(texts[k], LEFT - 5, y(mark)); });
    draw.stroke();
    const ratio = canvas.width / width;
    if (layer.canvas.width !== Math.round(ratio * inner()) || layer.canvas.height !== canvas.height) {
      [layer.canvas.width, layer.canvas.height] = [Math.round(ratio * inner()), canvas.height];
      image = layer.createImageData(layer.canvas.width, layer.canvas.height);
    }
    image.data.fill(0);
    const slope = (floor - top) / (high - low) * ratio;
    for (const line of lines) trace(line, floor * ratio + low * slope, slope, ratio * (line.run === state.reference && !line.dashed && lines.length > 1 ? 2 : 1.3));
    layer.putImageData(image, 0, 0);
    draw.drawImage(layer.canvas, LEFT, 0, inner(), tall);
  }

  // Lines are set as pixels: drawn as paths, those of 36 runs would take ten times as long.
  const layer = el("canvas").getContext("2d", { willReadFrequently: true });
  let image = null;
  /** Red, green and blue of a colour as the low bytes of a pixel. */
  const pixelOf = (colour) => cached(`@${colour}`, () => {
    const dot = el("canvas", { width: 1, height: 1 }).getContext("2d");
    dot.fillStyle = colour;
    dot.fillRect(0, 0, 1, 1);
    const [red, green, blue] = dot.getImageData(0, 0, 1, 1).data;
    return red | (green << 8) | (blue << 16);
  });
  /** A line at y = zero - slope * value: of each column of pixels what it covers, its ends by their share. */
  function trace({ run, values, colour, dashed }, zero, slope, thick) {
    const { width: wide, height: tall } = image, pixels = new Uint32Array(image.data.buffer);
    const [above, below] = [new Float32Array(wide).fill(Infinity), new Float32Array(wide).fill(-Infinity)];
    const scale = wide / (state.to - state.from), last = Math.min(before(run, state.to) + 1, run.count - 1);
    let [x0, y0] = [NaN, NaN];
    for (let i = before(run, state.from); i <= last; i++) {
      const x1 = ((state.over === "t" ? i / run.rate_hz : run.place[i]) - state.from) * scale, y1 = zero - slope * values[i];
      const from = Math.max(Math.floor(x0), 0), to = Math.min(Math.floor(x1), wide - 1), step = x1 > x0 ? (y1 - y0) / (x1 - x0) : 0;
      // A value that is none leaves a gap: nothing is less or more than it.
      for (let column = from; column <= to; column++) {
        const a = column > x0 ? y0 + step * (column - x0) : y0, b = column + 1 < x1 ? y0 + step * (column + 1 - x0) : y1;
        if (a < above[column]) above[column] = a;
        if (a > below[column]) below[column] = a;
        if (b < above[column]) above[column] = b;
        if (b > below[column]) below[column] = b;
      }
      [x0, y0] = [x1, y1];
    }
    const pixel = pixelOf(colour);
    for (let column = 0; column < wide; column++) {
      if (!(above[column] <= below[column]) || (dashed && column % 9 > 5)) continue;
      const [upper, lower] = [Math.max(above[column] - 0.5 * thick, 0), Math.min(below[column] + 0.5 * thick, tall)];
      for (let row = Math.floor(upper); row < lower; row++) {
        const share = Math.min(row + 1, lower) - Math.max(row, upper), alpha = Math.round(255 * share), at = row * wide + column;
        if (alpha >= pixels[at] >>> 24) pixels[at] = ((alpha << 24) | pixel) >>> 0;
      }
    }
  }

  /** Events of a run on the axis: [kind, from, to, text]. */
  function eventsOf(run) {
    return cached(`${run.run}\n@events\n${state.over}`, () => {
      const time = (s) => { const i = (s - run.t0_s) * run.rate_hz; return state.over === "t" ? i / run.rate_hz : run.place[Math.min(Math.max(Math.round(i), 0), run.count - 1)]; };
      const place = (m) => { if (state.over === "s") return m; let i = run.place.findIndex((s) => s >= m); if (i < 0) i = run.count - 1; return i / run.rate_hz; };
      const label = (key) => channelOf.get(key)?.label ?? key;
      return [
        ...run.sections.map((one) => ["section", place(one.from_m), place(one.to_m), `differs from the model in ${label(one.column)}${Math.abs(one.lost_s) >= 5e-4 ? `, ${one.lost_s > 0 ? "loses" : "gains"} ${figure(Math.abs(one.lost_s), 2)} s` : ""}`]),
        ...run.contacts.map(([from, to]) => ["contact", time(from), time(to), "pushed from outside"]),
        ...run.stretches.map((one) => [one.kind, time(one.from_s), time(one.to_s), one.column ? `${EVENTS[one.kind][0]}: ${label(one.column)}` : EVENTS[one.kind][0]]),
      ];
    });
  }
  function paintEvents({ canvas, tall }) {
    const draw = pen(canvas, tall), shown = listed(), row = Math.min(11, (tall - 6) / Math.max(shown.length, 1));
    draw.textAlign = "right";
    draw.textBaseline = "middle";
    shown.forEach((run, k) => {
      const y = 3 + k * row;
      draw.fillStyle = scheme["--plot"];
      draw.fillRect(LEFT, y, inner(), Math.max(row - 2, 1));
      for (const [kind, from, to] of eventsOf(run)) {
        const [a, b] = [Math.max(toX(from), LEFT), Math.min(toX(to), width - RIGHT)];
        draw.fillStyle = scheme[EVENTS[kind][1]];
        if (b >= a) draw.fillRect(a - 1, y, Math.max(b - a, 2), Math.max(row - 2, 1));
      }
      draw.fillStyle = scheme["--soft"];
      if (row >= 10) draw.fillText(run.run.length > 9 ? `${run.run.slice(0, 8)}\u2026` : run.run, LEFT - 5, y + 5);
    });
  }

  // The range: the reference's speed over the whole, the part that is shown, and the marks of the axis.
  let [start, finish] = [0, 1];
  function whole() {
    const shown = listed().length > 0 ? listed() : [state.reference];
    start = Math.min(...shown.map((run) => xOf(run, 0)));
    finish = Math.max(...shown.map((run) => xOf(run, run.count - 1)));
    if (!(finish > start)) finish = start + 1;
    [state.from, state.to] = [start, finish];
  }
  const barX = (x) => LEFT + inner() * (x - start) / (finish - start);
  function paintBar() {
    const draw = pen(bar, BAR), speed = measured(state.reference, "v_mps"), run = state.reference;
    const top = speed.reduce((most, value) => (value > most ? value : most), 1e-9);
    draw.fillStyle = scheme["--plot"];
    draw.fillRect(LEFT, 2, inner(), 26);
    draw.fillStyle = scheme["--accent"];
    draw.globalAlpha = 0.25;
    draw.fillRect(barX(state.from), 2, Math.max(barX(state.to) - barX(state.from), 2), 26);
    draw.globalAlpha = 1;
    draw.strokeStyle = scheme["--soft"];
    draw.beginPath();
    for (let i = 0; i < run.count; i += Math.max(1, Math.floor(run.count / inner()))) draw.lineTo(barX(xOf(run, i)), 27 - 23 * (speed[i] || 0) / top);
    draw.stroke();
    draw.fillStyle = scheme["--soft"];
    draw.textAlign = "center";
    const marks = ticks(state.from, state.to, Math.max(3, width / 110));
    tickTexts(marks).forEach((text, k) => draw.fillText(text, Math.min(toX(marks[k]), width - RIGHT - 10), 42));
    draw.textAlign = "left";
    draw.fillText(state.over === "t" ? "time [s]" : "distance [m]", LEFT, 57);
  }
  function show(from, to) {
    const least = (finish - start) * 1e-4, span = Math.min(Math.max(to - from, least), finish - start);
    const middle = 0.5 * (from + to), begin = Math.min(Math.max(middle - 0.5 * span, start), finish - span);
    [state.from, state.to] = [begin, begin + span];
    redraw();
  }
  const zoom = (by, about = state.cursor ?? 0.5 * (state.from + state.to)) => show(about + by * (state.from - about), about + by * (state.to - about));
  const pan = (share) => { const by = share * (state.to - state.from); show(state.from + by, state.to + by); };

  // The cursor and what it reads.
  function point(x) {
    state.cursor = x === null ? null : Math.min(Math.max(x, state.from), state.to);
    wait();
  }
  function read() {
    const x = state.cursor, inView = x !== null && x >= state.from && x <= state.to;
    host.style.setProperty("--cursor", inView ? `${toX(x)}px` : "-9px");
    readout.textContent = x === null ? "" : state.over === "t" ? `${figure(x)} s` : `${figure(x)} m`;
    for (const { channel, values, visible } of plots) {
      if (!visible) continue;
      if (x === null) { values.replaceChildren(); continue; }
      if (!channel) {
        const slack = 3 * (state.to - state.from) / inner();
        const here = listed().flatMap((run) => eventsOf(run).filter(([, from, to]) => x >= from - slack && x <= to + slack).map(([, , , text]) => `${run.run}: ${text}`));
        values.replaceChildren(few(here, 3).map((k) => here[k]).join("; "));
        continue;
      }
      const read = linesOf(channel.key).map((line) => ({ ...line, value: valueAt(line.run, line.values, x) })).filter(({ value }) => Number.isFinite(value));
      if (read.length <= FEW_LINES) { values.replaceChildren(...read.map(({ name, colour, value }) => el("span", { style: `color:${colour}` }, `${read.length > 1 ? `${name} ` : ""}${figure(value)}`))); continue; }
      const all = read.map(({ value }) => value), own = read.find(({ run }) => run === state.reference);
      values.replaceChildren(`${own ? `${own.name} ${figure(own.value)}, ` : ""}${all.length} runs ${figure(Math.min(...all))} to ${figure(Math.max(...all))}`);
    }
  }

  function fillFindings() {
    const faults = (run) => run.faults.map((one) => [run.run, one.proven ? "wrong" : "doubt", one.columns.join(", "), `${one.looks_like}: ${one.evidence}`]);
    const notes = (run) => run.notes.map((one) => [run.run, "odd", one.column, one.what]);
    const rows = listed().flatMap((run) => [...faults(run), ...notes(run)]);
    const legend = Object.values(EVENTS).map(([name, colour]) => el("span", {}, el("span", { class: "swatch", style: `background:var(${colour})` }), name));
    findings.replaceChildren(el("h2", {}, "Findings of the shown runs"), rows.length > 0 ? table(["run", "", "channel", "what"], rows) : el("p", { class: "soft" }, "none"),
      el("p", { class: "legend soft" }, "events:", legend),
      el("p", { class: "soft" }, `Channels are low-passed at 0.4 of ${figure(data.rate_hz)} Hz and packed in 16 bits. Drag over a plot to enlarge a part; Ctrl and the wheel, or two fingers, change the scale; Shift and the wheel, or the bar above, move it; keys: arrows, + and \u2212, 0.`));
  }

  // Pointers: a mouse drags out a part, one finger moves the cursor, two change the scale.
  const fingers = new Map();
  let dragged = null;
  const within = (event) => event.clientX - host.getBoundingClientRect().left;
  const part = el("div", { class: "part", hidden: true });
  host.addEventListener("pointerdown", (event) => {
    fingers.set(event.pointerId, within(event));
    if (event.pointerType === "mouse" && event.button === 0) { dragged = within(event); host.setPointerCapture(event.pointerId); }
    point(fromX(within(event)));
  });
  host.addEventListener("pointermove", (event) => {
    const at = within(event), old = fingers.get(event.pointerId);
    if (fingers.size === 2 && old !== undefined) {
      const [other] = [...fingers].filter(([id]) => id !== event.pointerId).map(([, x]) => x);
      const [a, b] = [fromX(old), fromX(other)], span = Math.max(Math.abs(at - other), 10) * Math.sign(at - other || 1);
      const scale = (a - b) / span, from = b + (LEFT - other) * scale;
      fingers.set(event.pointerId, at);
      show(from, from + inner() * scale);
      return;
    }
    if (old !== undefined) fingers.set(event.pointerId, at);
    if (dragged !== null && Math.abs(at - dragged) > 4) {
      host.append(part);
      part.hidden = false;
      part.style.left = `${Math.min(at, dragged)}px`;
      part.style.width = `${Math.abs(at - dragged)}px`;
    }
    point(fromX(at));
  });
  const release = (event) => {
    fingers.delete(event.pointerId);
    const at = within(event);
    if (dragged !== null && event.type === "pointerup" && Math.abs(at - dragged) > 4) show(...[fromX(dragged), fromX(at)].sort((a, b) => a - b));
    dragged = null;
    part.hidden = true;
  };
  for (const kind of ["pointerup", "pointercancel"]) host.addEventListener(kind, release);
  host.addEventListener("dblclick", () => { whole(); redraw(); });
  host.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.shiftKey && Math.abs(event.deltaX) <= Math.abs(event.deltaY)) return;
    event.preventDefault();
    if (event.ctrlKey) zoom(Math.exp(0.002 * event.deltaY), fromX(within(event)));
    else pan(0.001 * (event.deltaX || event.deltaY));
  }, { passive: false });
  host.addEventListener("keydown", (event) => {
    const step = (state.to - state.from) / 200, at = state.cursor ?? 0.5 * (state.from + state.to);
    const does = { ArrowLeft: () => (event.shiftKey ? pan(-0.1) : point(at - step)), ArrowRight: () => (event.shiftKey ? pan(0.1) : point(at + step)), "+": () => zoom(1 / 1.6), "-": () => zoom(1.6), 0: () => { whole(); redraw(); } }[event.key];
    if (!does) return;
    event.preventDefault();
    does();
  });
  const follow = (event) => {
    if (event.buttons === 0) return;
    bar.setPointerCapture(event.pointerId);
    const middle = start + (finish - start) * (event.clientX - bar.getBoundingClientRect().left - LEFT) / inner(), half = 0.5 * (state.to - state.from);
    show(middle - half, middle + half);
  };
  bar.addEventListener("pointerdown", follow);
  bar.addEventListener("pointermove", follow);

  readScheme();
  onScheme(() => { readScheme(); redraw(true); });
  whole();
  const stated = ["from", "to"].map((name) => Number.parseFloat(address.get(name)));
  if (stated.every(Number.isFinite)) show(...stated);
  addEventListener("hashchange", () => location.reload());
  new ResizeObserver(([entry]) => {
    const now = Math.round(entry.contentRect.width);
    if (now === width || now < LEFT + RIGHT + 20) return;
    width = now;
    requestAnimationFrame(() => { size(bar, BAR); redraw(true); });
  }).observe(host);
}

runsPage(document.getElementById("main"), pageData());
