//! Open worlds: runs by a third generator, in which data are wrong as those of real sleds are, in
//! many ways at once.
//!
//! The physics is written anew: two tracks of runners on a frame with roll and torsion, a lateral
//! law of another form than the magic formula, a driver in the loop, implicit midpoint at 2 kHz
//! ([`ride`]). The finder gets a rigid sled with one track that is as close to it as can be
//! ([`sled::Sled::one_track`]).
//!
//! | family | everything of [`faults`] and of the two-track sled |
//! |---|---|
//! | `open-quiet` | a tenth of what a careful team has |
//! | `open-ordinary` | what a careful team has |
//! | `open-bad` | twice that |
//!
//! | case | hides besides |
//! |---|---|
//! | `none` | nothing |
//! | `one` | one effect of the catalogue |
//! | `law` | one law of a recorded column that no effect of the catalogue has |
//! | `two` | two effects of the catalogue |
//! | `cause` | something that neither effects nor laws of one column can represent |
//!
//! What is hidden, and how many sessions and runs there are, is drawn by the seed. Its size is the
//! one that adds the stated share of the noise's variance to the residuals of the quiet family
//! after a refit of the base; it is the same in all families.

pub mod campaign;
pub mod faults;
pub mod gauge;
pub mod hidden;
pub mod recorder;
pub mod ride;
pub mod sled;
pub mod track;

use std::fmt::Write as _;

use crate::cases::answer::{Answer, Case, Hides};
use crate::cases::label::Label;
use crate::world::noise::Source;
use campaign::{Campaign, Run};
use faults::Family;
use gauge::{Gauge, refitted};
use hidden::{CATALOGUE, CAUSES, Effect, Hidden, LAWS, Secret};
use recorder::{NOISE, ROWS_HZ, Row};
use ride::RATE_HZ;

/// Shares of the noise's variance that hidden things have.
pub const SHARES: [f64; 2] = [0.02, 0.2];

/// What a case hides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hiding {
    /// Nothing.
    None,
    /// An effect of the catalogue.
    One,
    /// A law outside it.
    Law,
    /// Two effects of the catalogue.
    Two,
    /// What nothing can represent.
    Cause,
}

impl Hiding {
    /// All, each with its name in the list of cases.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::None, "none"),
        (Self::One, "one"),
        (Self::Law, "law"),
        (Self::Two, "two"),
        (Self::Cause, "cause"),
    ];

    /// Draws what is hidden, not yet sized.
    fn draw(self, campaign: &Campaign, source: &mut Source) -> Vec<Hidden> {
        let from: &[Effect] = match self {
            Self::None => return Vec::new(),
            Self::One | Self::Two => CATALOGUE,
            Self::Law => LAWS,
            Self::Cause => CAUSES,
        };
        let mut order: Vec<&Effect> = from.iter().collect();
        source.shuffle(&mut order);
        let count = if self == Self::Two { 2 } else { 1 };
        let hidden = |effect: &&Effect| Hidden {
            effect: **effect,
            size: if effect.signed { source.sign() } else { 1.0 },
            place_m: campaign.wall_m(),
        };
        order.iter().take(count).map(hidden).collect()
    }
}

/// Builds a case.
pub fn build(family: Family, hiding: Hiding, label: &Label, seed: u64) -> Case {
    // The same campaign, whatever is hidden in it and how large.
    let id = format!("open worlds {hiding:?}");
    let campaign = Campaign::draw(family.scale(), seed, &id);
    let source = &mut Source::new(seed, &format!("{id} secret"));
    let mut hidden = hiding.draw(&campaign, source);
    let mut hides = Vec::new();
    if let Some(share) = label.share {
        let quiet = Campaign::draw(Family::Quiet.scale(), seed, &id);
        let gauge = Gauge::new(&quiet);
        for hidden in &mut hidden {
            let reached = gauge.size(hidden, share);
            hides.push(answer_of(hidden, reached, &campaign));
        }
    }
    let secret = Secret(hidden);
    let fresh_session = campaign.sessions.len() - 1;
    let is_fresh = |run: &&Run| run.session == fresh_session;
    let (fresh, runs): (Vec<&Run>, Vec<&Run>) = campaign.runs.iter().partition(is_fresh);
    let record = |run: &&Run| campaign.record(run, &secret, RATE_HZ, true);
    let rows: Vec<Vec<Row>> = runs.iter().map(record).collect();
    let (mu, lateral) = campaign.stated();
    let weighed = campaign.faults.weighed(&campaign.sled);
    let model = |mu, lateral| weighed.model(mu, lateral) + &noise(campaign.faults.scale);
    let mut files = data(&campaign, &runs, &rows);
    files.push(("model.toml".to_owned(), model(mu, lateral).into_bytes()));
    let (mu_refitted, lateral_refitted) = refitted(&campaign, &runs, &rows);
    let fresh_rows: Vec<Vec<Row>> = fresh.iter().map(record).collect();
    let mut fresh_files = data(&campaign, &fresh, &fresh_rows);
    let text = model(mu_refitted, lateral_refitted);
    fresh_files.push(("refitted.toml".to_owned(), text.into_bytes()));
    let [front, rear] = campaign.sled.one_track();
    let base = [
        ("friction.longitudinal.mu", campaign.sled.mu),
        ("friction.front.k_n_per_rad", front[0]),
        ("friction.front.mu_zeta", front[1]),
        ("friction.rear.k_n_per_rad", rear[0]),
        ("friction.rear.mu_zeta", rear[1]),
    ];
    Case {
        files,
        fresh: fresh_files,
        answer: Answer {
            family: label.family.to_owned(),
            name: label.name.clone(),
            wanted_share: label.share,
            seed,
            data: "runs.csv".to_owned(),
            model: Some("model.toml".to_owned()),
            hides,
            tolerated: campaign
                .faults
                .true_names(&campaign.sessions[..fresh_session]),
            too_little_to_name: false,
            base: base.map(|(key, value)| (key.to_owned(), value)).to_vec(),
        },
    }
}

fn answer_of(hidden: &Hidden, share: f64, campaign: &Campaign) -> Hides {
    let effect = &hidden.effect;
    Hides {
        effect: effect.name.to_owned(),
        class: effect.class.iter().map(|name| (*name).to_owned()).collect(),
        key: effect.key.to_owned(),
        size: hidden.size,
        unit: effect.unit.to_owned(),
        share,
        places: hidden.places(campaign),
    }
}

/// Index, runs and tracks.
fn data(campaign: &Campaign, runs: &[&Run], rows: &[Vec<Row>]) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    let mut index = String::from("run,file,track,driver,driver_class,session,ice_c,air_c,air_pa\n");
    for (run, rows) in runs.iter().zip(rows) {
        let session = &campaign.sessions[run.session];
        let (name, track) = (&run.name, campaign.tracks[run.track].name);
        let (number, ice_c, [air_c, air_pa]) = (run.session + 1, session.ice_c[1], session.air);
        let _ = writeln!(
            index,
            "{name},{name}.csv,{track},{},all,{number},{ice_c},{air_c},{air_pa}",
            run.driver
        );
        files.push((format!("{name}.csv"), run_file(rows).into_bytes()));
    }
    files.push(("runs.csv".to_owned(), index.into_bytes()));
    for (track, off) in campaign.tracks.iter().zip(&campaign.survey) {
        let text = track.survey(off);
        files.push((format!("track_{}.csv", track.name), text.into_bytes()));
    }
    files
}

fn run_file(rows: &[Row]) -> String {
    let mut text = String::from(
        "t_s,ax_mps2,ay_mps2,az_mps2,roll_rate_radps,pitch_rate_radps,yaw_rate_radps,v_mps,\
         alpha_rad,delta_rad,gamma_rad,runner_c\n",
    );
    for (k, row) in rows.iter().enumerate() {
        let _ = write!(text, "{:.2}", k as f64 / ROWS_HZ);
        for value in row {
            let _ = write!(text, ",{value:.6}");
        }
        text.push('\n');
    }
    text
}

/// The model file's statements on survey and noise. Tolerances are the finder's own.
fn noise(scale: f64) -> String {
    format!(
        "\n[survey]\nslope_sd_rad = {:?}\n\n[noise]\naccel_mps2 = {:?}\nrate_radps = {:?}\n\
         speed_mps = {:?}\nslip_rad = {:?}\nsteer_rad = {:?}\nroll_split_rad = {:?}\n",
        1e-3 * scale,
        NOISE[0],
        NOISE[3],
        NOISE[6],
        NOISE[7],
        NOISE[8],
        NOISE[9]
    )
}
