// Scalar products in a fixed order: each thread every 65536th number, then by halves.

@group(0) @binding(0) var<storage, read> a: array<f32>;
@group(0) @binding(1) var<storage, read> b: array<f32>;
// A pair a . b, a . a a group.
@group(0) @binding(2) var<storage, read_write> parts: array<vec2<f32>>;
// rho, alpha, beta, r . r, its target, iterations, p . K p.
@group(0) @binding(3) var<storage, read_write> factors: array<f32>;

var<workgroup> sums: array<vec2<f32>, 256>;

fn halve(thread: u32) {
    for (var half = 128u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if thread < half {
            sums[thread] += sums[thread + half];
        }
    }
}

@compute @workgroup_size(256, 1, 1)
fn products(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    var sum = vec2<f32>(0.0);
    for (var at = id.x; at < arrayLength(&a); at += 65536u) {
        sum += a[at] * vec2<f32>(b[at], a[at]);
    }
    sums[thread] = sum;
    halve(thread);
    if thread == 0u {
        parts[group.x] = sums[0];
    }
}

// From r . z and r . r of a start.
@compute @workgroup_size(256, 1, 1)
fn begin(@builtin(local_invocation_index) thread: u32) {
    sums[thread] = parts[thread];
    halve(thread);
    if thread == 0u {
        factors[0] = sums[0].x;
        factors[2] = 0.0;
        factors[3] = sums[0].y;
        factors[5] = 0.0;
    }
}

// alpha from p . K p; 0, so that nothing moves any more, once the target is reached or the energy is not positive.
@compute @workgroup_size(256, 1, 1)
fn step(@builtin(local_invocation_index) thread: u32) {
    sums[thread] = parts[thread];
    halve(thread);
    if thread == 0u {
        let energy = sums[0].x;
        let rho = factors[0];
        var alpha = 0.0;
        if energy > 0.0 && rho > 0.0 && factors[3] > factors[4] {
            alpha = rho / energy;
            factors[5] += 1.0;
        }
        factors[1] = alpha;
        factors[6] = energy;
    }
}

// beta from r . z and r . r.
@compute @workgroup_size(256, 1, 1)
fn after(@builtin(local_invocation_index) thread: u32) {
    sums[thread] = parts[thread];
    halve(thread);
    if thread == 0u {
        let next = sums[0].x;
        let rho = factors[0];
        var beta = 0.0;
        if rho > 0.0 && factors[1] > 0.0 {
            beta = next / rho;
        }
        factors[0] = next;
        factors[2] = beta;
        factors[3] = sums[0].y;
    }
}
