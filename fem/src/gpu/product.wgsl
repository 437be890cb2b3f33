// Matrix products in tiles of 32 x 32, out = left right, for many matrices at once.

struct Product {
    rows: u32,
    cols: u32,
    inner: u32,
    left_start: u32,
    left_row: u32,
    left_col: u32,
    left_matrix: i32,
    right_start: u32,
    right_row: u32,
    right_col: u32,
    right_matrix: i32,
    out_start: u32,
    out_matrix: i32,
}

@group(0) @binding(0) var<uniform> product: Product;
@group(0) @binding(1) var<storage, read> left: array<f32>;
@group(0) @binding(2) var<storage, read> right: array<f32>;
@group(0) @binding(3) var<storage, read_write> out: array<f32>;

// One row more than needed, so that neither way of filling them meets one bank again and again.
var<workgroup> left_tile: array<f32, 528>;
var<workgroup> right_tile: array<f32, 528>;

fn place(start: u32, matrix: i32, number: u32) -> u32 {
    return u32(i32(start) + matrix * i32(number));
}

@compute @workgroup_size(8, 8, 1)
fn multiply(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let first_row = 32u * group.x;
    let first_col = 32u * group.y;
    let left_first = place(product.left_start, product.left_matrix, group.z);
    let right_first = place(product.right_start, product.right_matrix, group.z);
    var sums: array<vec4<f32>, 4>;
    for (var done = 0u; done < product.inner; done += 16u) {
        for (var part = 0u; part < 8u; part++) {
            let number = 64u * part + thread;
            // Threads go along what lies side by side in memory.
            let along_rows = product.left_row == 1u;
            let i = select(number / 16u, number % 32u, along_rows);
            let l = select(number % 16u, number / 32u, along_rows);
            let row = first_row + i;
            let inner = done + l;
            var value = 0.0;
            if row < product.rows && inner < product.inner {
                value = left[left_first + row * product.left_row + inner * product.left_col];
            }
            left_tile[33u * l + i] = value;

            let along_inner = product.right_row == 1u;
            let j = select(number % 32u, number / 16u, along_inner);
            let m = select(number / 32u, number % 16u, along_inner);
            let col = first_col + j;
            let inner_right = done + m;
            var other = 0.0;
            if col < product.cols && inner_right < product.inner {
                other = right[right_first + inner_right * product.right_row + col * product.right_col];
            }
            right_tile[33u * m + j] = other;
        }
        workgroupBarrier();
        for (var l = 0u; l < 16u; l++) {
            let a = 33u * l + local.x;
            let b = 33u * l + local.y;
            let column = vec4<f32>(left_tile[a], left_tile[a + 8u], left_tile[a + 16u], left_tile[a + 24u]);
            sums[0] += column * right_tile[b];
            sums[1] += column * right_tile[b + 8u];
            sums[2] += column * right_tile[b + 16u];
            sums[3] += column * right_tile[b + 24u];
        }
        workgroupBarrier();
    }
    let out_first = place(product.out_start, product.out_matrix, group.z);
    for (var b = 0u; b < 4u; b++) {
        for (var a = 0u; a < 4u; a++) {
            let row = first_row + local.x + 8u * a;
            let col = first_col + local.y + 8u * b;
            if row < product.rows && col < product.cols {
                out[out_first + col * product.rows + row] = sums[b][a];
            }
        }
    }
}
