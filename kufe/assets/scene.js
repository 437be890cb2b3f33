// Bodies that turn, drawn by three.js; z is up.

/**
 * A stage in a new element; `draw(spec)` fills it.
 *
 * spec: { bodies: [{ positions, index, colours, colour, opacity, lift }], edges: [numbers], marks: [{ at: [x, y, z], text }] }.
 * Everything is in the box's own units, about -1 to 1. Without WebGL the stage says so, and the rest of the page goes on.
 */
function stage(label) {
  const box = el("div", { class: "stage" });
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  } catch {
    box.append(el("p", { class: "none" }, "This browser offers no WebGL, so nothing turns here. The map and the cuts show the same fields."));
    return { box, draw() {}, reset() {}, works: false };
  }
  const canvas = renderer.domElement;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", label);
  const scene = new THREE.Scene(), content = new THREE.Group();
  const camera = new THREE.PerspectiveCamera(32, 1, 0.05, 50);
  camera.up.set(0, 0, 1);
  const controls = new THREE.OrbitControls(camera, canvas);
  controls.enablePan = false;
  controls.minDistance = 1;
  controls.maxDistance = 12;
  const sun = new THREE.DirectionalLight(0xffffff, 1.6);
  sun.position.set(1.5, -2.5, 3);
  scene.add(content, sun, new THREE.AmbientLight(0xffffff, 1.7));
  const overlay = el("div", { "aria-hidden": "true" });
  box.append(canvas, overlay);
  let spec = null, frame = 0, width = 0, height = 0;

  function reset() {
    camera.position.set(-1.5, -2.9, 1.9).multiplyScalar(width > 0 && width < 1.25 * height ? 1.45 : 1);
    controls.target.set(0, 0, -0.05);
    controls.update();
  }
  function render() {
    frame = 0;
    if (width === 0) return;
    renderer.render(scene, camera);
    for (const mark of overlay.children) {
      const at = new THREE.Vector3(...mark.place).project(camera);
      const x = (at.x + 1) / 2 * width, y = (1 - at.y) / 2 * height;
      // What is hidden has no width.
      mark.hidden = at.z > 1 || x < 0 || x > width || y < 0 || y > height;
      // A label stays whole at the edge of the view.
      const half = [0.5 * mark.offsetWidth, 0.5 * mark.offsetHeight];
      const inside = [Math.min(Math.max(x, half[0]), width - half[0]), Math.min(Math.max(y, half[1]), height - half[1])];
      mark.style.transform = `translate(-50%, -50%) translate(${inside[0].toFixed(1)}px, ${inside[1].toFixed(1)}px)`;
    }
  }
  const ask = () => { frame ||= requestAnimationFrame(render); };
  function rebuild() {
    if (!spec) return;
    for (const old of [...content.children]) { content.remove(old); old.geometry.dispose(); old.material.dispose(); }
    renderer.setClearColor(new THREE.Color(ink("plot")));
    for (const body of spec.bodies) content.add(meshOf(body));
    const edges = new THREE.BufferGeometry();
    edges.setAttribute("position", new THREE.BufferAttribute(new Float32Array(spec.edges), 3));
    content.add(new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: new THREE.Color(ink("soft")), transparent: true, opacity: 0.6 })));
    overlay.replaceChildren(...spec.marks.map(({ at, text }) => Object.assign(el("span", { class: "mark" }, text), { place: at })));
    ask();
  }
  controls.addEventListener("change", ask);
  onScheme(rebuild);
  new ResizeObserver(([entry]) => {
    const first = width === 0;
    [width, height] = [entry.contentRect.width, entry.contentRect.height];
    if (width > 0 && height > 0) requestAnimationFrame(() => resize(first));
  }).observe(box);
  function resize(first) {
    renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    if (first) reset();
    ask();
  }
  return { box, canvas, works: true, reset, draw(next) { spec = next; rebuild(); } };
}

function meshOf({ positions, index, colours, colour, opacity = 1, lift = 0 }) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
  geometry.setIndex(index);
  if (colours) geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
  geometry.computeVertexNormals();
  const material = new THREE.MeshLambertMaterial({
    vertexColors: Boolean(colours), color: colours ? 0xffffff : new THREE.Color(ink(colour)),
    side: THREE.DoubleSide, transparent: opacity < 1, opacity, depthWrite: opacity === 1,
  });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.position.z = lift;
  mesh.renderOrder = opacity < 1 ? 1 : 0;
  return mesh;
}

/**
 * A surface over nx by ny points: `at(i, j)` gives its place, `colour(i, j)` its [r, g, b] of 255.
 *
 * With a rim { inside(i, j), share(a, b) } only what is inside is drawn, cut where the rim crosses the cells: `share` is how far it is on the way from
 * a point a = [i, j] inside to its neighbour b outside, 0 to 1. A cell without a place beyond its inside has none at all: `share` is then null.
 */
function surface(nx, ny, at, colour, rim) {
  const positions = [], colours = [], index = [], crossings = new Map(), tone = new THREE.Color();
  const tint = ([r, g, b]) => { tone.set(`rgb(${r},${g},${b})`); colours.push(tone.r, tone.g, tone.b); };
  const points = Array.from({ length: nx * ny }, (_, k) => [k % nx, Math.floor(k / nx)]);
  const inside = points.map(([i, j]) => !rim || rim.inside(i, j));
  for (const [i, j] of points) {
    positions.push(...at(i, j));
    if (colour) tint(colour(i, j));
  }
  /** The vertex on the rim between two points, the first of them inside. */
  function crossing(k, l) {
    const key = k * nx * ny + l;
    if (crossings.has(key)) return crossings.get(key);
    const share = rim.share(points[k], points[l]);
    if (share === null) return null;
    // Triangles without an area have no side that light falls on.
    const t = Math.min(0.98, Math.max(0.02, share)), mix = (list, c) => list[3 * k + c] + t * (list[3 * l + c] - list[3 * k + c]);
    for (const list of colour ? [positions, colours] : [positions]) list.push(...[0, 1, 2].map((c) => mix(list, c)));
    crossings.set(key, positions.length / 3 - 1);
    return positions.length / 3 - 1;
  }
  function triangle(...corners) {
    const piece = [];
    corners.forEach((k, n) => {
      const next = corners[(n + 1) % 3];
      if (inside[k]) piece.push(k);
      if (inside[k] !== inside[next]) piece.push(inside[k] ? crossing(k, next) : crossing(next, k));
    });
    if (piece.includes(null)) return;
    for (let n = 1; n + 1 < piece.length; n++) index.push(piece[0], piece[n], piece[n + 1]);
  }
  for (let j = 0; j + 1 < ny; j++) {
    for (let i = 0; i + 1 < nx; i++) {
      const [a, b, c, d] = [j * nx + i, j * nx + i + 1, (j + 1) * nx + i + 1, (j + 1) * nx + i];
      triangle(a, b, c);
      triangle(a, c, d);
    }
  }
  return { positions: new Float32Array(positions), index, colours: colour ? new Float32Array(colours) : null };
}

/** The twelve edges of a box, as pairs of points. */
function boxEdges([x0, x1], [y0, y1], [z0, z1]) {
  const edges = [];
  for (const [a, b] of [[y0, z0], [y0, z1], [y1, z0], [y1, z1]]) edges.push(x0, a, b, x1, a, b);
  for (const [a, b] of [[x0, z0], [x0, z1], [x1, z0], [x1, z1]]) edges.push(a, y0, b, a, y1, b);
  for (const [a, b] of [[x0, y0], [x0, y1], [x1, y0], [x1, y1]]) edges.push(a, b, z0, a, b, z1);
  return edges;
}

/** A colour of the style sheet as [r, g, b] of 255. */
function rgbOf(name) {
  const hex = ink(name).slice(1);
  return [0, 2, 4].map((k) => parseInt(hex.slice(k, k + 2), 16));
}
