//! Speed of the solver's kernels relative to the limits of this machine: memory bandwidth and matrix
//! products.
//!
//! `cargo run --release -p kufe-benches --bin limits`
//!
//! | kernel | bound by | its limit here |
//! |---|---|---|
//! | operator | reading u and writing K u, 48 bytes per node | a stream triad on every thread |
//! | operator | 52 multiplications, with or without an addition, and 48 additions per node | such operations in registers, on every thread |
//! | preconditioner | four matrix products per component, in single precision | faer's product of the same shapes on every thread |
//! | table evaluation | reading the four corners of a cell | such reads at known places, on one thread |

use std::hint::black_box;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use kufe_benches::{best_of, measure_again, needle_block, pressure_table, random_queries};
use kufe_lut::{Interpolator, Mode, Point, Quantity};
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

/// Numbers in each of the triad's three arrays: far more than any cache holds.
const STREAM: usize = 1 << 26;
/// Numbers per task of the triad.
const CHUNK: usize = 1 << 16;
const ROUNDS: usize = 7;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.first() {
        Some(cells) => {
            let cells = cells
                .parse()
                .unwrap_or_else(|_| panic!("{cells}: expected a number of cells"));
            // On a thread of rayon, as in the solver.
            rayon::scope(|_| kernels(cells));
        }
        None => tables(),
    }
}

fn tables() {
    let triad = triad();
    println!("### Kernels and this machine's limits\n");
    println!(
        "{} threads. Stream triad: {:.1} GB/s. faer, product of 512 x 512 matrices in single precision, on every thread at once: \
         {:.1} Gflop/s.",
        rayon::current_num_threads(),
        triad / 1e9,
        plane_products(512, 512, 512) / 1e9
    );
    let mixture = operator_mixture();
    println!(
        "The operator's mixture of {FUSED} fused or plain multiplications and {ADDED} additions a node, in registers alone, on every \
         thread: {:.2} ns a node, as long as the triad takes for {:.0} bytes.\n",
        1e9 * mixture,
        mixture * triad
    );
    println!(
        "| unknowns | operator | of the bandwidth | of the arithmetic | preconditioner | its rate | faer, same shapes | share |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for cells in ["32", "69", "100"] {
        let [unknowns, operator, bytes, preconditioner, flops, faer] = measure_again(&[cells]);
        println!(
            "| {unknowns:.0} | {:.2} ms | {:.0} % | {:.0} % | {:.2} ms | {:.1} Gflop/s | {:.1} Gflop/s | {:.0} % |",
            1e3 * operator,
            100.0 * bytes / operator / triad,
            100.0 * bytes / BYTES * mixture / operator,
            1e3 * preconditioner,
            flops / preconditioner / 1e9,
            flops / faer / 1e9,
            100.0 * faer / preconditioner
        );
    }
    let (evaluation, reads) = table_evaluation();
    println!(
        "\nTable of 64 x 64 nodes, bilinear, one thread: {evaluation:.1} ns an evaluation; its four corners alone, read at places \
         known beforehand, {reads:.1} ns ({:.0} %).",
        100.0 * reads / evaluation
    );
}

/// Times of an evaluation of a table, and of reading the four corners of each query's cell [ns].
fn table_evaluation() -> (f64, f64) {
    const SIZE: usize = 64;
    let table = pressure_table(SIZE).unwrap_or_else(|error| panic!("{error}"));
    let lookup = Interpolator::new(&table, Quantity::PMax, Mode::Bilinear, None)
        .unwrap_or_else(|error| panic!("{error}"));
    let queries = random_queries();
    let per_query = 1e9 / queries.len() as f64;
    let (evaluation, _) = best_of(ROUNDS, || {
        queries
            .iter()
            .map(|&(fz, k)| lookup.at(Point::at_rest(black_box(fz), black_box(k))).value)
            .sum::<f64>()
    });
    let values = table.values(Quantity::PMax).unwrap_or_default();
    let corners: Vec<usize> = queries
        .iter()
        .map(|&(fz, k)| {
            let below =
                |axis: &[f64], v: f64| axis.partition_point(|&b| b <= v).clamp(1, SIZE - 1) - 1;
            below(table.axes().fz(), fz) * SIZE + below(table.axes().curvature(), k)
        })
        .collect();
    let (reads, _) = best_of(ROUNDS, || {
        corners
            .iter()
            .map(|&i| {
                let i = black_box(i);
                values[i] + values[i + 1] + values[i + SIZE] + values[i + SIZE + 1]
            })
            .sum::<f64>()
    });
    (per_query * evaluation, per_query * reads)
}

/// Bandwidth of a = b + s c [bytes/s], counting one write and two reads per number.
fn triad() -> f64 {
    let (b, c) = (vec![1.0f64; STREAM], vec![2.0f64; STREAM]);
    let mut a = vec![0.0f64; STREAM];
    let scale = black_box(3.0);
    let (seconds, ()) = best_of(ROUNDS, || {
        a.par_chunks_mut(CHUNK)
            .zip(b.par_chunks(CHUNK))
            .zip(c.par_chunks(CHUNK))
            .for_each(|((a, b), c)| {
                for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                    *a = b + scale * c;
                }
            });
    });
    assert!(a.iter().all(|&a| a == 7.0));
    24.0 * STREAM as f64 / seconds
}

/// Bytes that the operator reads and writes per node.
const BYTES: f64 = 48.0;
/// Operations per inner node of the operator (`kufe-fem`, tensor_kernel.rs): multiplications, of
/// which 29 with an addition in one instruction, and further additions.
const FUSED: usize = 52;
const ADDED: usize = 48;

/// Time of these operations per node with their numbers in registers, on all threads [s].
fn operator_mixture() -> f64 {
    const NODES: usize = 1 << 21;
    let threads = rayon::current_num_threads();
    let (seconds, sums) = best_of(ROUNDS, || {
        let work = (0..threads).into_par_iter();
        work.map(|_| pulp::Arch::new().dispatch(Mixture { nodes: NODES }))
            .sum::<f64>()
    });
    assert!(black_box(sums).is_finite());
    seconds / (NODES * threads) as f64
}

/// The operations of `nodes` nodes in independent chains.
struct Mixture {
    nodes: usize,
}

/// Numbers of fused chains and of chains of additions: an operation takes up to four cycles, and
/// processors start two of each kind per cycle.
const CHAINS: [usize; 2] = [8, 6];

impl WithSimd for Mixture {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (factor, step) = (
            simd.splat_f64s(black_box(0.999)),
            simd.splat_f64s(black_box(1e-3)),
        );
        let mut fused = [simd.splat_f64s(1.0); CHAINS[0]];
        let mut added = [simd.splat_f64s(0.0); CHAINS[1]];
        // One operation of each fused chain per round, and one of each chain of additions in so many
        // rounds that the ratio of both is right.
        let rounds = self.nodes * FUSED / (S::F64_LANES * CHAINS[0]);
        let mut due = 0;
        for _ in 0..rounds {
            for value in &mut fused {
                *value = simd.mul_add_e_f64s(*value, factor, step);
            }
            due += ADDED * CHAINS[0];
            if due >= FUSED * CHAINS[1] {
                due -= FUSED * CHAINS[1];
                for value in &mut added {
                    *value = simd.add_f64s(*value, step);
                }
            }
        }
        let chains = fused.into_iter().chain(added);
        chains.map(|chain| simd.reduce_sum_f64s(chain)).sum()
    }
}

/// Rate of rows x inner by inner x cols matrix products in single precision, one product per thread
/// [flop/s].
fn plane_products(rows: usize, inner: usize, cols: usize) -> f64 {
    let left = Mat::<f32>::from_fn(rows, inner, |i, j| (i + 2 * j) as f32);
    let right = Mat::<f32>::from_fn(inner, cols, |i, j| (i as f32 - j as f32).sin());
    let flops = 2.0 * (rows * inner * cols) as f64;
    let threads = rayon::current_num_threads();
    let repeats = ((4e9 / flops) as usize).max(1) * threads;
    let mut targets = vec![Mat::<f32>::zeros(rows, cols); threads];
    let (seconds, ()) = best_of(ROUNDS, || {
        targets.par_iter_mut().for_each(|target| {
            for _ in 0..repeats / threads {
                matmul(
                    target.as_mut(),
                    Accum::Replace,
                    black_box(left.as_ref()),
                    right.as_ref(),
                    1.0,
                    Par::Seq,
                );
            }
        });
    });
    flops * repeats as f64 / seconds
}

/// Prints unknowns, the operator's time [s] and bytes, the preconditioner's time [s] and operations,
/// and faer's time for these operations [s].
fn kernels(cells: usize) {
    let block = needle_block(cells);
    let (operator, preconditioner) = (&block.operator, &block.preconditioner);
    let [nx, ny, nz] = operator.shape();
    let nodes = operator.node_count();
    let u: Vec<f64> = (0..3 * nodes).map(|i| (0.37 * i as f64).sin()).collect();
    let mut out = vec![0.0; 3 * nodes];
    let (apply, ()) = best_of(20 * ROUNDS, || operator.apply(black_box(&u), &mut out));
    let mut modal = vec![0.0; preconditioner.mode_count()];
    let (precondition, ()) = best_of(ROUNDS, || {
        preconditioner.apply(black_box(&u), &mut out, &mut modal)
    });
    let mut flops = 0.0;
    for fixed in &operator.fixed {
        let modes = |axis: usize| operator.axes[axis].modes(fixed[axis]).values.len();
        let (mx, my) = (modes(0), modes(1));
        flops += 4.0 * (mx * nx * ny * nz + mx * ny * my * nz) as f64;
    }
    let ideal = flops / plane_products(nx, nx, ny);
    println!(
        "{} {apply} {} {precondition} {} {ideal}",
        operator.free_dofs(),
        BYTES * nodes as f64,
        flops
    );
}
