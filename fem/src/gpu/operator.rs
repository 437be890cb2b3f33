//! K u on the device.

use crate::error::Error;
use crate::gpu::device::open::Device;
use crate::gpu::device::work::Work;
use crate::gpu::units::Units;
use crate::tensor::operator::TensorOperator;

/// Threads of a group along x and y, as the shader has them.
const GROUP: [usize; 2] = [16, 4];

/// Planes that one thread goes through: it reads the two beside them too.
const PLANES: usize = 8;

/// `out` = K `u` / (modulus length), 0 on held entries.
pub(super) fn stiffness(
    device: &Device,
    operator: &TensorOperator,
    units: &Units,
    [u, out]: [&wgpu::Buffer; 2],
) -> Result<Work, Error> {
    let [nx, ny, nz] = operator.shape();
    let mut held = 0;
    for (c, axes) in operator.held.iter().enumerate() {
        for (axis, ends) in axes.iter().enumerate() {
            for (end, &is_held) in ends.iter().enumerate() {
                held |= u32::from(is_held) << (6 * c + 2 * axis + end);
            }
        }
    }
    let [x, y, z] = operator.axes.each_ref().map(|axis| &axis.nodes);
    let mut axes = around(x, units.length);
    axes.extend(around(y, units.length));
    let lower = operator.lower_layer();
    for (cell, w) in z.windows(2).enumerate() {
        let length = (w[1] - w[0]) / units.length;
        let [lambda, mu] = match lower {
            Some(layer) if cell < layer.cells => [layer.lambda, layer.mu],
            _ => [operator.lambda, operator.mu],
        };
        axes.extend([
            length,
            1.0 / length,
            lambda / units.modulus,
            mu / units.modulus,
        ]);
    }
    let axes: Vec<f32> = axes.iter().map(|v| *v as f32).collect();
    let shape = [nx, ny, nz, PLANES].map(|n| n as u32);
    let grid = device.parameters("grid", &[&shape[..], &[held]].concat());
    let axes = device.holding("axes", &axes)?;
    let kernel = device.kernel(include_str!("operator.wgsl"), "stiffness");
    let groups = [
        nx.div_ceil(GROUP[0]),
        ny.div_ceil(GROUP[1]),
        nz.div_ceil(PLANES),
    ];
    let buffers = [(0, &grid), (1, &axes), (2, u), (3, out)];
    device.work(&kernel, &buffers, groups)
}

/// Lengths of the cells below and above each node and one over them, 0 where there is no cell.
fn around(nodes: &[f64], unit: f64) -> Vec<f64> {
    let lengths: Vec<f64> = nodes.windows(2).map(|w| (w[1] - w[0]) / unit).collect();
    let inverse = |length: f64| if length > 0.0 { 1.0 / length } else { 0.0 };
    let of = |cell: Option<usize>| {
        let length = cell.and_then(|cell| lengths.get(cell));
        length.copied().unwrap_or(0.0)
    };
    (0..nodes.len())
        .flat_map(|i| {
            let (below, above) = (of(i.checked_sub(1)), of(Some(i)));
            [below, above, inverse(below), inverse(above)]
        })
        .collect()
}
