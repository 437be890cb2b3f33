// A field as colours, with axes, a colour bar and a cursor.

/**
 * A map in a new element; `draw(spec)` fills it.
 *
 * spec: { x: [from, to, title], y: [from, to, title], image: { nx, ny, x, y, value(i, j), draws(value) }, bar: [from, to, title],
 * dots: [[x, y]] }, `image.x` and `image.y` being the image's own ends. `onCursor(x, y, pinned)` hears where the cursor is.
 */
function heatMap(onCursor, height = 380) {
  const canvas = el("canvas", { tabindex: 0, role: "img", "aria-label": "map; arrow keys move the cursor" });
  const box = el("div", { class: "plot" }, canvas);
  let spec = null, image = null, cursor = null, width = 0;
  const frame = () => ({ left: 62, right: width - 92, top: 10, bottom: height - 46 });
  const place = (x, y) => {
    const { left, right, top, bottom } = frame();
    return [left + (right - left) * (x - spec.x[0]) / (spec.x[1] - spec.x[0]), bottom - (bottom - top) * (y - spec.y[0]) / (spec.y[1] - spec.y[0])];
  };
  const at = (event) => {
    const { left, right, top, bottom } = frame(), bounds = canvas.getBoundingClientRect();
    const u = (event.clientX - bounds.left - left) / (right - left), v = (bottom - (event.clientY - bounds.top)) / (bottom - top);
    if (u < 0 || u > 1 || v < 0 || v > 1) return null;
    return [spec.x[0] + u * (spec.x[1] - spec.x[0]), spec.y[0] + v * (spec.y[1] - spec.y[0])];
  };
  const hear = (event, pinned) => {
    if (!spec || width === 0) return;
    const found = at(event);
    if (!found) return;
    cursor = found;
    onCursor(...cursor, pinned);
    redraw();
  };
  canvas.addEventListener("pointermove", (event) => hear(event, event.buttons > 0));
  canvas.addEventListener("pointerdown", (event) => hear(event, true));
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] }[event.key];
    if (!step || !spec) return;
    event.preventDefault();
    const [x, y] = cursor ?? [(spec.x[0] + spec.x[1]) / 2, (spec.y[0] + spec.y[1]) / 2];
    const move = (value, [from, to], sign) => Math.min(to, Math.max(from, value + sign * (to - from) / (event.shiftKey ? 20 : 200)));
    cursor = [move(x, spec.x, step[0]), move(y, spec.y, step[1])];
    onCursor(...cursor, true);
    redraw();
  });

  function redraw() {
    if (!spec || width === 0) return;
    const ratio = Math.min(devicePixelRatio || 1, 2), { left, right, top, bottom } = frame();
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.height = `${height}px`;
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    pen.font = "12px system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', sans-serif";
    pen.fillStyle = ink("plot");
    pen.fillRect(left, top, right - left, bottom - top);
    const [x0, y1] = place(spec.image.x[0], spec.image.y[0]), [x1, y0] = place(spec.image.x[1], spec.image.y[1]);
    pen.save();
    pen.beginPath(); pen.rect(left, top, right - left, bottom - top); pen.clip();
    pen.imageSmoothingEnabled = true;
    pen.drawImage(image, x0, y0, x1 - x0, y1 - y0);
    pen.restore();
    for (const [x, y, share] of spec.dots ?? []) {
      const [px, py] = place(x, y);
      pen.fillStyle = share === undefined ? "#fff" : `rgb(${viridis(share)})`; pen.strokeStyle = "#000"; pen.lineWidth = 0.8;
      pen.beginPath(); pen.arc(px, py, share === undefined ? 3 : 6, 0, 7); pen.fill(); pen.stroke();
    }
    pen.fillStyle = ink("soft"); pen.strokeStyle = ink("line");
    pen.strokeRect(left + 0.5, top + 0.5, right - left - 1, bottom - top - 1);
    const xs = ticks(spec.x[0], spec.x[1], Math.max(3, (right - left) / 80)), ys = ticks(spec.y[0], spec.y[1], 6);
    pen.textAlign = "center";
    tickTexts(xs).forEach((text, k) => pen.fillText(text, place(xs[k], 0)[0], bottom + 17));
    pen.fillText(spec.x[2], (left + right) / 2, height - 8);
    pen.textAlign = "right";
    tickTexts(ys).forEach((text, k) => pen.fillText(text, left - 6, place(0, ys[k])[1] + 4));
    turned(pen, spec.y[2], 13, (top + bottom) / 2);
    bar(pen, right + 12, top, bottom);
    if (cursor) cross(pen, ...place(...cursor), { left, right, top, bottom });
  }
  function bar(pen, left, top, bottom) {
    const [from, to, title] = spec.bar, marks = ticks(from, to, 6);
    for (let k = 0; k < bottom - top; k++) {
      pen.fillStyle = `rgb(${viridis(1 - k / (bottom - top - 1))})`;
      pen.fillRect(left, top + k, 14, 1.5);
    }
    pen.fillStyle = ink("soft"); pen.textAlign = "left";
    tickTexts(marks).forEach((text, k) => pen.fillText(text, left + 19, bottom - (bottom - top) * (marks[k] - from) / (to - from || 1) + 4));
    turned(pen, title, left + 72, (top + bottom) / 2);
  }
  function turned(pen, text, x, y) {
    pen.save(); pen.translate(x, y); pen.rotate(-Math.PI / 2); pen.textAlign = "center"; pen.fillText(text, 0, 0); pen.restore();
  }
  function cross(pen, x, y, { left, right, top, bottom }) {
    for (const [colour, dash] of [["#000", []], ["#fff", [4, 4]]]) {
      pen.strokeStyle = colour; pen.setLineDash(dash); pen.lineWidth = 1;
      pen.beginPath(); pen.moveTo(left, y); pen.lineTo(right, y); pen.moveTo(x, top); pen.lineTo(x, bottom); pen.stroke();
    }
    pen.setLineDash([]);
  }

  new ResizeObserver(([entry]) => {
    const now = Math.round(entry.contentRect.width);
    if (now !== width) { width = now; requestAnimationFrame(redraw); }
  }).observe(box);
  onScheme(redraw);
  return {
    box,
    canvas,
    draw(next) { spec = next; image = painted(next.image, next.bar); redraw(); },
    /** Puts the cursor at a place without telling. */
    point(x, y) { cursor = [x, y]; redraw(); },
    /** Where a place is on the screen, for those who click there. */
    place,
  };
}

/** The image as a canvas of its own, its first row below. */
function painted({ nx, ny, value, draws }, [from, to]) {
  const canvas = el("canvas", { width: nx, height: ny });
  const pen = canvas.getContext("2d"), pixels = pen.createImageData(nx, ny);
  for (let j = 0; j < ny; j++) {
    for (let i = 0; i < nx; i++) {
      const found = value(i, j), k = 4 * ((ny - 1 - j) * nx + i);
      if (!draws(found)) continue;
      const [r, g, b] = viridis(to > from ? (found - from) / (to - from) : 0);
      pixels.data.set([r, g, b, 255], k);
    }
  }
  pen.putImageData(pixels, 0, 0);
  return canvas;
}
