//! A table's shards as a job array of a real Slurm on this machine.

use kufe_outside::{missing, not_here};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::kufe::Bench;

/// Daemons of a Slurm of one node, ended with this value.
struct Slurm {
    daemons: Vec<Child>,
    configuration: String,
}

impl Drop for Slurm {
    fn drop(&mut self) {
        for daemon in self.daemons.iter_mut().rev() {
            let end = format!("kill {}", daemon.id());
            let _ = Command::new("sh").args(["-c", &end]).status();
            let _ = daemon.wait();
        }
    }
}

fn has(program: &str) -> bool {
    Command::new(program)
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

fn daemon(program: &str, words: &[String], configuration: &str) -> Child {
    Command::new(program)
        .args(words)
        .env("SLURM_CONF", configuration)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the daemon starts")
}

fn free_port() -> u16 {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    listener.local_addr().expect("an address").port()
}

impl Slurm {
    /// None where slurmd finds no control groups, as in some containers.
    fn start(folder: &Path) -> Option<Slurm> {
        let text = |name: &str| folder.join(name).display().to_string();
        for name in ["state", "spool"] {
            std::fs::create_dir(folder.join(name)).unwrap();
        }
        let random = std::fs::File::open("/dev/urandom").unwrap();
        let mut key = Vec::new();
        std::io::Read::read_to_end(&mut std::io::Read::take(random, 128), &mut key).unwrap();
        std::fs::write(folder.join("munge.key"), key).unwrap();
        let mode = std::os::unix::fs::PermissionsExt::from_mode;
        std::fs::set_permissions(folder.join("munge.key"), mode(0o600)).unwrap();
        let host = Command::new("hostname").arg("-s").output().unwrap().stdout;
        let host = String::from_utf8(host).unwrap().trim().to_string();
        let lines = [
            "ClusterName=kufe".to_string(),
            format!("SlurmctldHost={host}(127.0.0.1)"),
            "SlurmUser=root\nSlurmdUser=root\nAuthType=auth/munge".into(),
            format!("AuthInfo=socket={}", text("munge.sock")),
            format!("SlurmctldPort={}\nSlurmdPort={}", free_port(), free_port()),
            format!(
                "StateSaveLocation={}\nSlurmdSpoolDir={}",
                text("state"),
                text("spool")
            ),
            format!(
                "SlurmctldPidFile={}\nSlurmdPidFile={}",
                text("c.pid"),
                text("d.pid")
            ),
            format!(
                "SlurmctldLogFile={}\nSlurmdLogFile={}",
                text("c.log"),
                text("d.log")
            ),
            "ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSelectType=select/cons_tres"
                .into(),
            "JobAcctGatherType=jobacct_gather/none\nMpiDefault=none\nReturnToService=2".into(),
            "SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,sched_interval=1".into(),
            format!("NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN"),
            "PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP".into(),
        ];
        let configuration = text("slurm.conf");
        std::fs::write(&configuration, lines.join("\n") + "\n").unwrap();
        let munge = [
            "--force".to_string(),
            "--foreground".into(),
            format!("--key-file={}", text("munge.key")),
            format!("--socket={}", text("munge.sock")),
            format!("--pid-file={}", text("munge.pid")),
            format!("--log-file={}", text("munge.log")),
            format!("--seed-file={}", text("munge.seed")),
        ];
        let mut slurm = Slurm {
            daemons: vec![daemon("munged", &munge, &configuration)],
            configuration: configuration.clone(),
        };
        wait_for("munge's socket", || folder.join("munge.sock").exists());
        slurm
            .daemons
            .push(daemon("slurmctld", &["-D".into()], &configuration));
        wait_for("the controller", || {
            slurm.output_of("scontrol", &["ping"]).contains("is UP")
        });
        let node = ["-D".to_string(), "-N".into(), host];
        slurm.daemons.push(daemon("slurmd", &node, &configuration));
        let mut ended = false;
        wait_for("the node", || {
            let node = slurm.daemons.last_mut().expect("the daemons");
            ended = node.try_wait().expect("its state").is_some();
            ended
                || slurm
                    .output_of("sinfo", &["-h", "-o", "%T"])
                    .contains("idle")
        });
        if ended {
            slurm.daemons.pop();
            let log = std::fs::read_to_string(folder.join("d.log")).unwrap_or_default();
            assert!(log.contains("initialize cgroup plugin"), "slurmd: {log}");
            return None;
        }
        Some(slurm)
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("SLURM_CONF", &self.configuration);
        command
    }

    fn output_of(&self, program: &str, words: &[&str]) -> String {
        let output = self
            .command(program)
            .args(words)
            .output()
            .expect("a Slurm program");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }
}

fn wait_for(what: &str, mut ready: impl FnMut() -> bool) {
    let started = Instant::now();
    while !ready() {
        assert!(
            started.elapsed() < Duration::from_secs(60),
            "{what} did not come up"
        );
        std::thread::sleep(Duration::from_millis(100));
    }
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn an_array_with_a_failing_shard_resubmitted_gives_the_table_of_one_process() {
    if !["sbatch", "slurmctld", "slurmd", "munged"]
        .iter()
        .all(|&program| {
            // slurmctld and slurmd know -V only.
            has(program) || Command::new(program).arg("-V").output().is_ok()
        })
    {
        missing("Slurm and munge are not installed (apt-get install slurm-wlm munge)");
        return;
    }
    let user = Command::new("id").arg("-u").output().unwrap().stdout;
    if user.trim_ascii() != b"0" {
        not_here("a Slurm of its own needs root");
        return;
    }
    let bench = Bench::new();
    bench.write(
        "case.toml",
        "[runner]\nshape = { kind = \"paraboloid\", rocker_radius_m = 30.0, section_radius_m = 0.005 }\n\
         [ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n[load]\nfz_n = 1.0\n",
    );
    bench.write(
        "table.toml",
        "case = \"case.toml\"\n[axes]\nfz_n = { values = [250.0, 700.0, 2000.0] }\ncurvature_1pm = { values = [-0.01, 0.0, 0.01, 0.02] }\n",
    );
    bench.succeeds(&["lut", "table.toml", "-o", "whole.lut"]);
    bench.succeeds(&["lut", "plan", "table.toml", "-o", "plan", "--shards", "4"]);
    // The script as written, with a command that fails the first time it is given shard 3.
    let script = std::fs::read_to_string(bench.path("plan/slurm.sh")).unwrap();
    let real = env!("CARGO_BIN_EXE_kufe");
    let flaky = bench.path("flaky.sh");
    let marker = bench.path("failed-once");
    bench.write(
        "flaky.sh",
        format!(
            "#!/bin/sh\ncase \"$*\" in *'--shard 3/4'*)\n  if [ ! -e {0} ]; then touch {0}; exit 1; fi;;\nesac\nexec {real} \"$@\"\n",
            marker.display()
        ),
    );
    std::fs::set_permissions(&flaky, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let script = script.replace(&format!("'{real}'"), &format!("'{}'", flaky.display()));
    assert!(script.contains("flaky.sh"), "{script}");
    bench.write("array.sh", script);

    let folder = tempfile::tempdir().unwrap();
    let Some(slurm) = Slurm::start(folder.path()) else {
        not_here("Slurm's node finds no control groups");
        return;
    };
    let submit = || {
        let array = bench.path("array.sh");
        let output = slurm
            .command("sbatch")
            .arg("--wait")
            .arg(array)
            .output()
            .unwrap();
        (
            output.status.success(),
            String::from_utf8_lossy(&output.stderr).into_owned(),
        )
    };
    let (all_well, printed) = submit();
    assert!(
        !all_well && marker.exists(),
        "shard 3 fails the first time: {printed}"
    );
    let early = bench.kufe(&["lut", "merge", "plan", "-o", "merged.lut"]);
    let text = String::from_utf8_lossy(&early.stderr).into_owned();
    assert!(
        early.status.code() == Some(5) && text.contains("4 of 16 points"),
        "{text}"
    );
    let (all_well, printed) = submit();
    assert!(all_well, "{printed}");
    bench.succeeds(&["lut", "merge", "plan", "-o", "merged.lut"]);
    assert!(
        std::fs::read(bench.path("whole.lut")).unwrap()
            == std::fs::read(bench.path("merged.lut")).unwrap()
    );
}
