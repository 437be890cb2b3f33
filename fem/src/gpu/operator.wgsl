// K u on a tensor grid of trilinear hexahedra: one thread a column of nodes through some planes.
//
// Each line of three nodes gives with the differences a, b to the neighbours above and below, a missing one counting as
// the node itself, and e = (a cell below) - (a cell above):
//
//     M u = (h_b + h_a) u / 2 + (h_a a - h_b b) / 6,   K u = b / h_b - a / h_a,
//     D^T u = (a + b) / 2,                             D u = e u - D^T u.
//
// Along z the matrices are taken cell by cell, so that each cell may have moduli of its own.

struct Grid {
    nx: u32,
    ny: u32,
    nz: u32,
    planes: u32,
    // Bit 6 c + 2 axis + end: component c is held there.
    held: u32,
}

@group(0) @binding(0) var<uniform> grid: Grid;
// Nodes of x, then of y: lengths of the cells below and above and one over them, 0 without a cell; then cells of z:
// length, one over it, lambda, mu.
@group(0) @binding(1) var<storage, read> axes: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> u: array<f32>;
@group(0) @binding(3) var<storage, read_write> out: array<f32>;

struct Line {
    m: vec3<f32>,
    k: vec3<f32>,
    t: vec3<f32>,
    d: vec3<f32>,
}

fn line(cells: vec4<f32>, low: vec3<f32>, on: vec3<f32>, high: vec3<f32>) -> Line {
    let below = on - low;
    let above = high - on;
    let e = f32(cells.x > 0.0) - f32(cells.y > 0.0);
    var to: Line;
    to.m = 0.5 * (cells.x + cells.y) * on + (cells.y * above - cells.x * below) * (1.0 / 6.0);
    to.k = cells.z * below - cells.w * above;
    to.t = 0.5 * (below + above);
    to.d = e * on - to.t;
    return to;
}

// What a plane gives along z: M by lambda + 2 mu, by mu and by lambda, K, D^T and D.
struct Plane {
    own: vec2<f32>,
    shear: vec3<f32>,
    lame: vec2<f32>,
    value: vec3<f32>,
    t: vec3<f32>,
    d: vec3<f32>,
}

fn node(i: u32, j: u32, k: u32) -> vec3<f32> {
    let at = (k * grid.ny + j) * grid.nx + i;
    let nodes = grid.nx * grid.ny * grid.nz;
    return vec3<f32>(u[at], u[nodes + at], u[2u * nodes + at]);
}

fn row(i: u32, j: u32, k: u32) -> Line {
    let low = select(i - 1u, 0u, i == 0u);
    let high = min(i + 1u, grid.nx - 1u);
    return line(axes[i], node(low, j, k), node(i, j, k), node(high, j, k));
}

fn plane(i: u32, j: u32, k: u32) -> Plane {
    let cells = axes[grid.nx + j];
    let on = row(i, j, k);
    var low = on;
    if j > 0u {
        low = row(i, j - 1u, k);
    }
    var high = on;
    if j + 1u < grid.ny {
        high = row(i, j + 1u, k);
    }
    let m = line(cells, low.m, on.m, high.m);
    let k_m = line(cells, low.k, on.k, high.k).m;
    let t = line(cells, low.t, on.t, high.t);
    let d = line(cells, low.d, on.d, high.d);
    var to: Plane;
    to.own = vec2<f32>(k_m.x, m.k.y);
    to.shear = vec3<f32>(m.k.x + t.d.y, k_m.y + d.t.x, k_m.z + m.k.z);
    to.lame = vec2<f32>(d.t.y, t.d.x);
    to.value = m.m;
    to.t = vec3<f32>(d.m.z, m.d.z, d.m.x + m.d.y);
    to.d = vec3<f32>(t.m.z, m.t.z, t.m.x + m.t.y);
    return to;
}

fn weighted(values: Plane, lambda: f32, mu: f32) -> vec3<f32> {
    return (lambda + 2.0 * mu) * vec3<f32>(values.own, 0.0) + mu * values.shear + lambda * vec3<f32>(values.lame, 0.0);
}

fn is_held(c: u32, i: u32, j: u32, k: u32) -> bool {
    let bits = grid.held >> (6u * c);
    return ((bits & 1u) != 0u && i == 0u) || ((bits & 2u) != 0u && i + 1u == grid.nx)
        || ((bits & 4u) != 0u && j == 0u) || ((bits & 8u) != 0u && j + 1u == grid.ny)
        || ((bits & 16u) != 0u && k == 0u) || ((bits & 32u) != 0u && k + 1u == grid.nz);
}

fn store(i: u32, j: u32, k: u32, value: vec3<f32>) {
    let at = (k * grid.ny + j) * grid.nx + i;
    let nodes = grid.nx * grid.ny * grid.nz;
    for (var c = 0u; c < 3u; c++) {
        out[c * nodes + at] = select(value[c], 0.0, is_held(c, i, j, k));
    }
}

@compute @workgroup_size(16, 4, 1)
fn stiffness(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    let j = id.y;
    if i >= grid.nx || j >= grid.ny {
        return;
    }
    let first = id.z * grid.planes;
    let end = min(first + grid.planes, grid.nz);
    let start = select(first - 1u, 0u, first == 0u);
    var below = plane(i, j, start);
    var sum = vec3<f32>(0.0);
    for (var k = start + 1u; k <= min(end, grid.nz - 1u); k++) {
        let above = plane(i, j, k);
        let cell = axes[grid.nx + grid.ny + k - 1u];
        let lambda = cell.z;
        let mu = cell.w;
        let own = lambda + 2.0 * mu;
        let low = weighted(below, lambda, mu);
        let high = weighted(above, lambda, mu);
        let stretch = cell.y * vec3<f32>(mu, mu, own) * (above.value - below.value);
        let slope = 0.5 * vec3<f32>(lambda, lambda, mu) * (above.t - below.t);
        let mean = 0.5 * vec3<f32>(mu, mu, lambda) * (below.d + above.d);
        let mass = cell.x * (1.0 / 6.0);
        sum += mass * (2.0 * low + high) - stretch + slope - mean;
        if k > first {
            store(i, j, k - 1u, sum);
        }
        sum = mass * (low + 2.0 * high) + stretch + slope + mean;
        below = above;
    }
    if end == grid.nz {
        store(i, j, grid.nz - 1u, sum);
    }
}
