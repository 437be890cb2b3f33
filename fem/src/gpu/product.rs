//! Products of many small matrices on the device.

use crate::error::Error;
use crate::gpu::device::open::Device;
use crate::gpu::device::work::Work;

/// Rows and columns of a tile, as the shader has them.
const TILE: usize = 32;

/// Matrices in a buffer: where the first begins, numbers from row to row, column to column and matrix to matrix.
#[derive(Clone, Copy)]
pub(super) struct Matrices<'a> {
    pub buffer: &'a wgpu::Buffer,
    pub start: usize,
    pub row: usize,
    pub col: usize,
    pub matrix: isize,
}

/// `out` = `left` `right` for `count` matrices of `rows` x `inner` and `inner` x `cols`; columns of `out` are whole and
/// follow each other.
pub(super) fn product(
    device: &Device,
    kernel: &wgpu::ComputePipeline,
    [rows, cols, inner, count]: [usize; 4],
    left: Matrices,
    right: Matrices,
    out: Matrices,
) -> Result<Work, Error> {
    debug_assert_eq!((out.row, out.col), (1, rows));
    let numbers = [
        rows as u32,
        cols as u32,
        inner as u32,
        left.start as u32,
        left.row as u32,
        left.col as u32,
        left.matrix as i32 as u32,
        right.start as u32,
        right.row as u32,
        right.col as u32,
        right.matrix as i32 as u32,
        out.start as u32,
        out.matrix as i32 as u32,
    ];
    let parameters = device.parameters("product", &numbers);
    let buffers = [
        (0, &parameters),
        (1, left.buffer),
        (2, right.buffer),
        (3, out.buffer),
    ];
    let groups = [rows.div_ceil(TILE), cols.div_ceil(TILE), count];
    device.work(kernel, &buffers, groups)
}

/// The kernel of [`product`].
pub(super) fn kernel(device: &Device) -> wgpu::ComputePipeline {
    device.kernel(include_str!("product.wgsl"), "multiply")
}
