// Updates of conjugate gradients; factors come from the sums before.

@group(0) @binding(0) var<storage, read> factors: array<f32>;
@group(0) @binding(1) var<storage, read> along: array<f32>;
@group(0) @binding(2) var<storage, read> image: array<f32>;
@group(0) @binding(3) var<storage, read_write> first: array<f32>;
@group(0) @binding(4) var<storage, read_write> second: array<f32>;

// d += alpha p, r -= alpha K p
@compute @workgroup_size(256, 1, 1)
fn advance(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let alpha = factors[1];
    for (var at = id.x; at < arrayLength(&first); at += 256u * groups.x) {
        first[at] += alpha * along[at];
        second[at] -= alpha * image[at];
    }
}

// p = z + beta p
@compute @workgroup_size(256, 1, 1)
fn turn(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let beta = factors[2];
    for (var at = id.x; at < arrayLength(&first); at += 256u * groups.x) {
        first[at] = along[at] + beta * first[at];
    }
}
