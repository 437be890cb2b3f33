// Tridiagonal matrices side by side: one thread each, through all planes in the order of elimination.

struct Column {
    pairs: u32,
    planes: u32,
    // Where values and pivots, shifts, and couplings begin.
    start: u32,
    shift_start: u32,
    coupling_start: u32,
}

@group(0) @binding(0) var<uniform> column: Column;
@group(0) @binding(1) var<storage, read> inverse: array<f32>;
@group(0) @binding(2) var<storage, read> shifts: array<f32>;
@group(0) @binding(3) var<storage, read> couplings: array<vec2<f32>>;
@group(0) @binding(4) var<storage, read_write> values: array<f32>;

fn off(plane: u32, shift: f32) -> f32 {
    let coupling = couplings[column.coupling_start + plane];
    return coupling.x + shift * coupling.y;
}

// y_i = r_i - T_(i,i-1) y_(i-1) / pivot_(i-1)
@compute @workgroup_size(64, 1, 1)
fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
    let pair = id.x;
    if pair >= column.pairs {
        return;
    }
    let shift = shifts[column.shift_start + pair];
    var at = column.start + pair;
    var before = values[at];
    for (var plane = 1u; plane < column.planes; plane++) {
        let taken = before * inverse[at];
        at += column.pairs;
        before = values[at] - off(plane, shift) * taken;
        values[at] = before;
    }
}

// z_i = (y_i - T_(i,i+1) z_(i+1)) / pivot_i
@compute @workgroup_size(64, 1, 1)
fn spread(@builtin(global_invocation_id) id: vec3<u32>) {
    let pair = id.x;
    if pair >= column.pairs {
        return;
    }
    let shift = shifts[column.shift_start + pair];
    var at = column.start + (column.planes - 1u) * column.pairs + pair;
    var after = values[at] * inverse[at];
    values[at] = after;
    for (var plane = column.planes - 1u; plane > 0u; plane--) {
        at -= column.pairs;
        after = (values[at] - off(plane, shift) * after) * inverse[at];
        values[at] = after;
    }
}
