//! The mirror planes x = 0 and y = 0 of a contact, of which one side is solved.

/// Number of symmetric images of the part that is solved, itself included.
pub(crate) fn image_count(planes: [bool; 2]) -> f64 {
    images(planes).count() as f64
}

/// The signs of x and y of a place and its images, the place itself first.
pub(crate) fn images(planes: [bool; 2]) -> impl Iterator<Item = [f64; 2]> {
    let [along, across] = planes.map(|used| if used { &[1.0, -1.0][..] } else { &[1.0] });
    let with = |x: f64| across.iter().map(move |&y| [x, y]);
    along.iter().flat_map(move |&x| with(x))
}

/// The nodes of an axis with their images, ascending: number and sign of each.
pub(crate) fn unfolded(count: usize, mirrored: bool) -> impl Iterator<Item = (usize, f64)> {
    let images = (1..count).rev().filter(move |_| mirrored);
    let images = images.map(|node| (node, -1.0));
    images.chain((0..count).map(|node| (node, 1.0)))
}
