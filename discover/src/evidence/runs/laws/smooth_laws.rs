//! Tests of the smooth laws of all columns on all channels.

use kufe_sled::effects::Channel;

use crate::evidence::runs::campaign::Campaign;
use crate::evidence::runs::laws::group_tests::{Group, test};
use crate::evidence::runs::laws::shape::{Shape, splines};
use crate::evidence::runs::laws::sums::total;
use crate::evidence::runs::laws::term::{COLUMNS, Term};
use crate::evidence::runs::laws::terms::Terms;
use crate::evidence::runs::screen::residual_screen::ScreenOptions;

/// Number of B-splines of a smooth law of a column: the data resolve no finer structure.
const SPLINES: usize = 7;
/// Weight of the penalty on second differences, in units of the mean information.
const SMOOTHING: f64 = 0.02;

/// A group of terms with its columns and cross-validated gain.
pub struct SmoothLaw {
    pub channel: usize,
    pub columns: Vec<usize>,
    pub gains: Vec<f64>,
    /// Whether it is significant.
    pub significant: bool,
}

impl Campaign<'_> {
    /// The channels that laws may act on.
    pub fn law_channels(&self) -> Vec<Channel> {
        let mut channels = Vec::new();
        if self.used[1] {
            channels.extend([Channel::Grip, Channel::Lateral, Channel::Yaw]);
        }
        if self.used[0] {
            channels.push(Channel::Friction);
        }
        channels
    }

    /// All smooth laws and products of columns, and the smallest p-value of the significant ones.
    pub fn smooth_laws(
        &self,
        terms: &Terms,
        channels: &[Channel],
        options: &ScreenOptions,
    ) -> (Vec<SmoothLaw>, f64) {
        let (mut list, mut groups, mut laws) = (Vec::new(), Vec::new(), Vec::new());
        let mut law = |channel, columns: Vec<usize>, shapes: Vec<Shape>| {
            let first = list.len();
            list.extend(shapes.into_iter().map(|shape| Term { channel, shape }));
            groups.push(match list.len() - first {
                1 => Group::single(first),
                _ => Group::spline(first..list.len(), SMOOTHING),
            });
            laws.push((channel, columns));
        };
        let varying: Vec<(usize, Vec<f64>)> = (0..terms.names.len())
            .map(|column| (column, terms.sorted(column)))
            .filter(|(_, x)| x.iter().all(|x| x.is_finite()) && x.first() < x.last())
            .collect();
        for (channel, kind) in channels.iter().enumerate() {
            for (column, sorted) in &varying {
                law(channel, vec![*column], splines(*column, sorted, SPLINES));
            }
            if !matches!(kind, Channel::Grip | Channel::Friction) {
                continue;
            }
            // A formula can contain one column outside the model; time is not combined with others.
            let own = |x: usize| x < COLUMNS.len() && COLUMNS[x].0 != "t_s";
            for (k, (a, _)) in varying.iter().enumerate().filter(|(_, (x, _))| own(*x)) {
                for (b, _) in varying[k + 1..].iter().filter(|(x, _)| own(*x)) {
                    law(channel, vec![*a, *b], vec![Shape::Product(*a, *b)]);
                }
            }
        }
        let parts: Vec<&[Term]> = list.chunk_by(|a, b| a.channel == b.channel).collect();
        let Some(sums) = terms.sums_of_parts(&parts, &[1.0]).pop() else {
            return (Vec::new(), 1.0);
        };
        let tested = test(&sums, &groups, options.flips, options.seed);
        let mut smallest = 1.0_f64;
        let laws = laws
            .into_iter()
            .enumerate()
            .map(|(g, (channel, columns))| {
                let group = &groups[g];
                let gains = sums.cross_validated_gains(&group.terms, &group.penalty);
                let p = tested.p_value(tested.z[g]);
                let significant = p <= options.alpha_column && total(&gains) > 0.0;
                if significant {
                    smallest = smallest.min(p);
                }
                SmoothLaw {
                    channel,
                    columns,
                    gains,
                    significant,
                }
            })
            .collect();
        (laws, smallest)
    }
}
