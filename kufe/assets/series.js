// The page of a series of contacts.
//
// Data: { name, keys: [what was varied], quantities: [{ key, error_key, label, unit, times }], rows: [table.json's rows] }; a radius that is
// infinite is the text "inf", a row without a solution has no numbers.

/** How a varied key is drawn: title, and its value on the axis; a radius is drawn as its curvature. */
const VARIED = {
  fz_n: ["normal force [N]", (value) => value],
  radius_m: ["track curvature 1/r [1/m]", (value) => (value === "inf" ? 0 : 1 / value)],
  rocker_radius_m: ["rocker radius [m]", (value) => value],
  pitch_rad: ["pitch [mrad]", (value) => 1e3 * value],
  roll_rad: ["roll [mrad]", (value) => 1e3 * value],
};

/** Most lines that are drawn; more are spread over what there is. */
const LINES = 9;

function seriesPage(main, data) {
  const solved = data.rows.filter((row) => Number.isFinite(row.p_max_pa)), failed = data.rows.filter((row) => row.error);
  const there = data.quantities.filter(({ key }) => solved.some((row) => Number.isFinite(row[key])));
  const option = (text, value) => el("option", { value }, text);
  const figureOf = el("select", { id: "figure", onchange: () => draw() }, there.map(({ label }, k) => option(label, k)));
  const over = el("select", { id: "over", onchange: () => draw() }, data.keys.map((key) => option(VARIED[key]?.[0] ?? key, key)));
  const varied = (key) => new Set(solved.map((row) => row[key])).size;
  over.value = data.keys.reduce((most, key) => (varied(key) > varied(most) ? key : most));
  const shown = chart(), note = el("p", { class: "soft" });
  const peaks = solved.map((row) => row.p_max_pa), seconds = solved.reduce((sum, row) => sum + (row.seconds ?? 0), 0);
  main.replaceChildren(
    el("header", {}, el("h1", {}, `${data.rows.length} contacts`), el("p", { class: "soft" }, data.name)),
    ...failed.map((row) => el("p", { class: "warning" }, `step ${row.step}: ${row.error}`)),
    el("ul", { class: "figures" }, figures([
      [`${figure(1e-6 * Math.min(...peaks))} to ${figure(1e-6 * Math.max(...peaks))} MPa`, "peak pressure"],
      ...data.keys.map((key) => [valuesOf(data.rows, key), VARIED[key]?.[0].replace(/^track curvature.*/, "track radius [m]") ?? key]),
      [`${figure(seconds, 3)} s`, "solved in"],
    ])),
    el("div", { class: "tools", style: "margin-bottom:.8rem" }, el("label", {}, "figure", figureOf), el("label", { hidden: data.keys.length < 2 }, "over", over)),
    el("div", { class: "panels" },
      el("section", { class: "panel wide" }, shown.box, note),
      el("section", { class: "panel wide" }, el("h2", {}, "Every contact"), everyContact(data, there))),
  );

  function draw() {
    const { key, label: title, unit, times, error_key: error } = there[figureOf.value], along = over.value, [name, place] = VARIED[along] ?? [along, Number];
    const others = data.keys.filter((other) => other !== along), groups = new Map();
    for (const row of solved) {
      const label = others.map((other) => labelOf(other, row[other])).join(", ");
      groups.set(label, [...(groups.get(label) ?? []), row]);
    }
    const every = [...groups], lines = few(every, LINES).map((k) => every[k]);
    shown.draw({
      x: { title: name }, y: { title: `${title} [${unit}]` }, height: 340,
      series: lines.map(([label, rows], k) => {
        const sorted = [...rows].sort((a, b) => place(a[along]) - place(b[along]));
        return {
          x: sorted.map((row) => place(row[along])), y: sorted.map((row) => (Number.isFinite(row[key]) ? times * row[key] : NaN)),
          errors: sorted.map((row) => times * (row[error] ?? 0)), points: true, name: label,
          colour: lines.length === 1 ? "var(--accent)" : `rgb(${viridis(0.35 + 0.5 * k / (lines.length - 1)).join(" ")})`,
        };
      }),
    });
    note.textContent = `Bars: stated errors, where they are larger than the points.${lines.length < groups.size ? ` ${lines.length} of ${groups.size} lines.` : ""}`;
  }
  draw();
}

const labelOf = (key, value) => {
  const [, name, unit] = key.match(/^(.*)_(n|m|rad)$/) ?? [null, key, ""];
  return `${name.replace("_", " ")} ${value}${unit ? ` ${unit === "n" ? "N" : unit}` : ""}`;
};

/** A few values as they are, many by their ends. */
function valuesOf(rows, key) {
  const values = [...new Set(rows.map((row) => row[key]))];
  return values.length <= 4 ? values.join(", ") : `${values[0]} to ${values[values.length - 1]}`;
}

/** A value and two digits of its error, both with the same decimals. */
function measured(value, error) {
  if (!(error > 0 && error < Infinity)) return figure(value);
  const decimals = Math.max(0, 1 - Math.floor(Math.log10(Number(error.toPrecision(2)))));
  return decimals > 6 ? `${figure(value)} \u00b1 ${error.toExponential(1)}` : `${value.toFixed(decimals)} \u00b1 ${error.toFixed(decimals)}`;
}

function everyContact(data, there) {
  // A step short of its accuracy has a map all the same.
  const link = (row) => (!Number.isFinite(row.p_max_pa) ? String(row.step) : el("a", { href: `${encodeURIComponent(row.folder)}/pressure.png` }, String(row.step)));
  const cell = (row, { key, times, error_key: error }) => {
    return Number.isFinite(row[key]) ? measured(times * row[key], times * row[error]) : "";
  };
  return table(["map", ...data.keys, ...there.map(({ label, unit }) => `${label} [${unit}]`)],
    data.rows.map((row) => [link(row), ...data.keys.map((key) => String(row[key])), ...there.map((one) => cell(row, one))]));
}

seriesPage(document.getElementById("main"), pageData());
