//! Sweeps in pieces: nothing lost, nothing solved twice, nothing mixed.

use crate::hertz::runner;
use kufe_lut::{
    Error, Manifest, Next, Origin, Plan, Point, Solved, Spacing, Store, SweepError, next_batch,
    solve_missing, sweep,
};
use std::convert::Infallible;
use std::sync::atomic::{AtomicUsize, Ordering};

fn plan() -> Plan {
    Plan::new(
        Spacing::Range {
            from: 200.0,
            to: 8000.0,
        },
        Spacing::Range {
            from: -0.02,
            to: 0.03,
        },
    )
}

fn origin(version: &str, case: &str) -> Origin {
    Origin {
        version: version.into(),
        case_sha256: case.into(),
    }
}

fn bytes(next: Next) -> Vec<u8> {
    let Next::Finished(swept) = next else {
        panic!("not finished")
    };
    let mut bytes = Vec::new();
    swept.table.write(&mut bytes).unwrap();
    bytes
}

#[test]
fn rounds_of_shards_give_the_table_of_one_process_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path(), origin("0.1.0", "ab")).unwrap();
    let mut rounds = 0;
    let merged = loop {
        match next_batch(&plan(), &store).unwrap() {
            Next::Points {
                points,
                round,
                missing,
                ..
            } => {
                rounds += 1;
                assert_eq!(round, rounds);
                assert_eq!(missing, points.len());
                let manifest = Manifest {
                    origin: store.origin().clone(),
                    table: "table.toml".into(),
                    round,
                    shards: 7,
                    points,
                };
                let path = folder.path().join("plan.json");
                manifest.write(&path).unwrap();
                let read = Manifest::read(&path).unwrap();
                assert_eq!(read, manifest);
                // Any order of the shards, some of them twice.
                for shard in [5, 3, 7, 3, 1, 2, 6, 4, 4] {
                    let points = read.shard(shard, 7).unwrap();
                    solve_missing(&store, points, alone(|p| Ok::<_, Infallible>(runner(p))))
                        .unwrap();
                }
            }
            finished => break bytes(finished),
        }
    };
    assert!(rounds > 1, "a tolerance needs rounds");
    let mut table = sweep(&plan(), |p| Ok::<_, Infallible>(runner(p)))
        .unwrap()
        .table;
    table.case_sha256 = "ab".into();
    let mut whole = Vec::new();
    table.write(&mut whole).unwrap();
    assert!(merged == whole);
}

#[test]
fn shards_share_the_points_without_gap_or_overlap() {
    let points: Vec<Point> = (0..23)
        .map(|n| Point {
            fz: 100.0 + f64::from(n),
            curvature: 0.0,
            ..Point::default()
        })
        .collect();
    let manifest = Manifest {
        origin: origin("1", "2"),
        table: String::new(),
        round: 1,
        shards: 1,
        points: points.clone(),
    };
    for count in [1, 2, 5, 23, 40] {
        let together: Vec<Point> = (1..=count)
            .flat_map(|i| manifest.shard(i, count).unwrap().to_vec())
            .collect();
        assert_eq!(together, points);
    }
    for (index, count) in [(0, 3), (4, 3), (1, 0)] {
        assert!(matches!(
            manifest.shard(index, count),
            Err(Error::Shard { .. })
        ));
    }
}

/// Every point by itself.
fn alone<E>(
    solve: impl Fn(&Point) -> Result<Solved, E>,
) -> impl Fn(&[Point]) -> Vec<Result<Solved, E>> {
    move |group| group.iter().map(&solve).collect()
}

fn some_points() -> Vec<Point> {
    (1..=20)
        .map(|n| Point {
            fz: 100.0 * f64::from(n),
            curvature: 0.001 * f64::from(n),
            ..Point::default()
        })
        .collect()
}

#[test]
fn finished_points_are_not_solved_again() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path(), origin("1", "2")).unwrap();
    let solves = AtomicUsize::new(0);
    let count = |p: &Point| {
        solves.fetch_add(1, Ordering::Relaxed);
        Ok::<_, Infallible>(runner(p))
    };
    let points = some_points();
    solve_missing(&store, &points[..12], alone(count)).unwrap();
    let done = solve_missing(&store, &points, alone(count)).unwrap();
    assert_eq!((done.solved, done.kept), (8, 12));
    assert_eq!(solves.load(Ordering::Relaxed), 20);
    for point in &points {
        assert_eq!(store.get(point).unwrap(), Some(runner(point)));
    }
    store.clear(&points).unwrap();
    assert!(!folder.path().exists());
}

#[derive(Debug, thiserror::Error)]
#[error("power cut")]
struct PowerCut;

#[test]
fn a_failed_point_leaves_the_others_finished() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path(), origin("1", "2")).unwrap();
    let points = some_points();
    let failed = solve_missing(
        &store,
        &points,
        alone(|p: &Point| {
            if p.fz == 700.0 {
                Err(PowerCut)
            } else {
                Ok(runner(p))
            }
        }),
    );
    match failed {
        Err(SweepError::Solve { point, .. }) => assert_eq!(point, points[6]),
        other => panic!("{other:?}"),
    }
    let done = solve_missing(&store, &points, alone(|p| Ok::<_, PowerCut>(runner(p)))).unwrap();
    assert_eq!((done.solved, done.kept), (1, 19));
}

#[test]
fn damaged_results_are_named_when_merged_and_solved_again_when_run() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path(), origin("1", "2")).unwrap();
    let points = some_points();
    solve_missing(&store, &points, alone(|p| Ok::<_, Infallible>(runner(p)))).unwrap();
    let path = store.path(&points[3]);
    let good = std::fs::read(&path).unwrap();
    let mut flipped = good.clone();
    let digit = flipped.iter().rposition(|b| *b == b'e').unwrap() - 1;
    flipped[digit] = if flipped[digit] == b'1' { b'2' } else { b'1' };
    let damages: [&[u8]; 4] = [b"", &good[..good.len() / 2], &flipped, b"{\"sha256\": 4}"];
    for damage in damages {
        std::fs::write(&path, damage).unwrap();
        match store.get(&points[3]) {
            Err(Error::Corrupt { path: named, .. }) => {
                assert_eq!(named, path.display().to_string())
            }
            other => panic!("{other:?}"),
        }
        let done =
            solve_missing(&store, &points, alone(|p| Ok::<_, Infallible>(runner(p)))).unwrap();
        assert_eq!((done.solved, done.kept, done.repaired.len()), (1, 19, 1));
        assert!(done.repaired[0].contains(path.file_name().unwrap().to_str().unwrap()));
        assert_eq!(std::fs::read(&path).unwrap(), good);
    }
    // A sound file in another point's place.
    std::fs::copy(store.path(&points[5]), &path).unwrap();
    assert!(
        store
            .get(&points[3])
            .unwrap_err()
            .to_string()
            .contains("it is not the result of")
    );
}

#[test]
fn versions_and_cases_are_not_mixed() {
    let folder = tempfile::tempdir().unwrap();
    let points = some_points();
    let first = Store::open(folder.path(), origin("1", "2")).unwrap();
    solve_missing(&first, &points, alone(|p| Ok::<_, Infallible>(runner(p)))).unwrap();
    for (other, what) in [
        (origin("9", "2"), "version"),
        (origin("1", "9"), "case_sha256"),
    ] {
        let store = Store::open(folder.path(), other).unwrap();
        let refused =
            solve_missing(&store, &points, alone(|p| Ok::<_, Infallible>(runner(p)))).unwrap_err();
        assert!(refused.to_string().contains(what), "{refused}");
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "in the way").unwrap();
    let refused = Store::open(&file.join("points"), origin("1", "2")).unwrap_err();
    assert!(refused.to_string().contains("file/points"), "{refused}");
    let store = Store::open(&folder.path().join("points"), origin("1", "2")).unwrap();
    std::fs::remove_dir_all(store.folder()).unwrap();
    let failed = solve_missing(
        &store,
        &some_points(),
        alone(|p| Ok::<_, Infallible>(runner(p))),
    );
    assert!(
        failed
            .unwrap_err()
            .to_string()
            .contains("cannot be written")
    );
}

#[test]
fn a_broken_plan_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.json");
    for text in [
        "",
        "[]",
        "{\"format\": \"kufe-lut\"}",
        "{\"format\":\"kufe-lut-plan\",\"format_version\":1}",
    ] {
        std::fs::write(&path, text).unwrap();
        let refused = Manifest::read(&path).unwrap_err().to_string();
        assert!(refused.contains("plan.json: damaged"), "{refused}");
    }
}
