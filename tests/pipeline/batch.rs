//! Studies on a cluster, with stand-ins for the commands of the batch systems.
//! `tests/cluster/check` runs them on a real Slurm.

use std::fs;

use serde_json::Value;

use crate::program::{Ended, Program, install};

const STUDY: &str = r#"
title = "Spread of tiny drops"
pipeline = "tiny.toml"
set = ["impact.end=1 ms", "post.panels=[]", "pack.spacing=0.6 mm", "relax.time=1 ms"]

[[axis]]
name = "velocity"
key = "body.drop.velocity"
values = ["1 m/s", "1.5 m/s"]

[[axis]]
name = "speed of sound"
points = [
    { label = "adaptive" },
    { label = "too low", set = ["method.wcsph.reference_speed=0.01 m/s"] },
]

[[figure]]
name = "energy"
column = "kinetic_energy_J"
of = "last"
"#;

/// Runs every task at once, as if the cluster were very fast.
const SBATCH: &str = r#"#!/bin/bash
script=${!#}
echo "$*" >> sbatch.log
[ -e later ] && { echo 7; exit; }
tasks=$(sed -n 's/^#SBATCH --array=\([0-9,]*\).*/\1/p' "$script")
for task in ${tasks//,/ }; do
    SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=$task bash "$script" >> tasks.log 2>&1
    echo "$task $?" >> codes.log
done
echo "7;cluster"
"#;

pub fn program(commands: &[(&str, &str)]) -> Program {
    let program = Program::with("study.toml", STUDY);
    fs::create_dir(program.path("bin")).unwrap();
    for (name, text) in commands {
        let written = program.path("command.txt");
        fs::write(&written, text).unwrap();
        install(&written, &program.path("bin").join(name));
    }
    program
}

fn slurm() -> Program {
    let log = |name: &str| format!("#!/bin/bash\necho \"$*\" >> {name}.log\n");
    let queue = "#!/bin/bash\necho \"$*\" >> squeue.log; cat queue 2> /dev/null\n:\n";
    program(&[
        ("sbatch", SBATCH),
        ("squeue", queue),
        ("scancel", &log("scancel")),
        ("scontrol", &log("scontrol")),
    ])
}

/// `coronet study study.toml` with more arguments, beside the stand-ins.
pub fn study(program: &Program, more: &[&str]) -> Ended {
    study_of(program, "study.toml", more)
}

pub fn study_of(program: &Program, file: &str, more: &[&str]) -> Ended {
    let mut command = program.command(&["study", file]);
    let path = format!("{}:/usr/bin:/bin", program.path("bin").display());
    command.args(more).env("PATH", path);
    command.output().unwrap().into()
}

pub fn read(program: &Program, name: &str) -> String {
    fs::read_to_string(program.path(name)).unwrap_or_default()
}

/// The table without the times.
pub fn table(program: &Program) -> Vec<String> {
    let text = read(program, "artifacts/latest/study/figures.csv");
    let lines = text.lines();
    lines
        .map(|line| line.rsplit_once(',').unwrap().0.to_string())
        .collect()
}

/// The local table, which others must equal.
pub fn local() -> Vec<String> {
    let program = program(&[]);
    study(&program, &[]).well();
    let table = table(&program);
    assert_eq!(table.len(), 5);
    let failed = table.iter().filter(|line| line.contains("diverged"));
    assert_eq!(failed.count(), 2, "{table:?}");
    table
}

#[test]
fn a_study_on_slurm_has_the_table_of_a_local_one() {
    let program = slurm();
    let options = [
        "--on",
        "slurm",
        "--partition",
        "short",
        "--time",
        "1:00:00",
        "--cores",
        "2",
    ];
    study(&program, &options).well();
    // The tasks of this cluster have ended by now, so the same command has collected them.
    assert_eq!(table(&program), local());
    let script = read(&program, "artifacts/latest/study/batch/job.sh");
    for line in [
        "#!/bin/bash",
        "#SBATCH --array=1,2,3,4",
        "#SBATCH --partition=short",
        "#SBATCH --time=1:00:00",
        "#SBATCH --cpus-per-task=2",
        "#SBATCH --requeue",
        "#SBATCH --signal=B:USR1@60",
        "#SBATCH --job-name=coronet-study",
    ] {
        assert!(
            script.lines().any(|found| found == line),
            "{line}: {script}"
        );
    }
    let memory = script
        .lines()
        .find(|line| line.starts_with("#SBATCH --mem="));
    let memory = memory.unwrap().trim_start_matches("#SBATCH --mem=");
    let memory: u32 = memory.trim_end_matches('M').parse().unwrap();
    assert!((300..1000).contains(&memory), "{memory}");
    assert_eq!(read(&program, "codes.log"), "1 0\n2 3\n3 0\n4 3\n");
    // Points that failed are not submitted again, unless their settings change.
    study(&program, &options).well();
    assert_eq!(read(&program, "sbatch.log").lines().count(), 1);
    let better = STUDY.replace("0.01 m/s", "20 m/s");
    fs::write(program.path("study.toml"), better).unwrap();
    study(&program, &options).well();
    assert_eq!(read(&program, "sbatch.log").lines().count(), 2);
    assert!(
        table(&program)
            .iter()
            .all(|line| !line.contains("diverged"))
    );
    assert!(!read(&program, "scontrol.log").contains("requeue"));
}

#[test]
fn a_submitted_study_is_looked_at_stopped_and_continued() {
    let program = slurm();
    fs::write(program.path("later"), "").unwrap();
    let queue = "7 1 RUNNING\n7 2 PENDING\n7 3 REQUEUED\n7 4 FAILED\n9 4 RUNNING\n";
    fs::write(program.path("queue"), queue).unwrap();
    let on = |more: &[&str]| study(&program, &[&["--on", "slurm"], more].concat());
    let ended = on(&["--json"]).well();
    let states = |ended: &Ended| {
        let last = ended.objects().pop().unwrap();
        let points = last["points"].as_array().unwrap().clone();
        let word = |point: &Value| point["state"].as_str().unwrap().to_string();
        points.iter().map(word).collect::<Vec<_>>()
    };
    let expected = ["running", "waiting", "waiting", "missing"];
    assert_eq!(states(&ended), expected);
    assert!(!program.path("artifacts/latest/study/figures.csv").exists());
    let submitted = || read(&program, "sbatch.log").lines().count();
    assert_eq!(submitted(), 1);
    assert_eq!(states(&on(&["--look", "--json"]).well()), expected);
    assert_eq!(submitted(), 1);
    let said = on(&["--look"]).well().out;
    assert!(said.contains("running in job 7"), "{said}");
    assert!(said.contains("1 running, 2 waiting, 1 missing"), "{said}");
    // Only what is in no job is submitted again.
    on(&[]).well();
    assert_eq!(submitted(), 2);
    let script = read(&program, "artifacts/latest/study/batch/job.sh");
    assert!(script.contains("#SBATCH --array=4\n"), "{script}");
    on(&["--cancel"]).well();
    assert_eq!(read(&program, "scancel.log"), "7\n");
    fs::remove_file(program.path("queue")).unwrap();
    fs::remove_file(program.path("later")).unwrap();
    let said = on(&["--wait", "--jobs", "3"]).well();
    assert_eq!(table(&program), local(), "{}", said.out);
    let script = read(&program, "artifacts/latest/study/batch/job.sh");
    assert!(script.contains("#SBATCH --array=1,2,3,4%3\n"), "{script}");
    assert!(on(&["--cancel"]).well().err.contains("no point"));
}

/// Where nodes share no store, they share results through a remote store.
#[test]
fn points_of_another_store_come_from_the_remote_store() {
    let shared = tempfile::tempdir().unwrap();
    let url = format!("file://{}", shared.path().display());
    let node = slurm();
    let done = STUDY.replace("0.01 m/s", "20 m/s");
    for program in [&node, &slurm()] {
        fs::write(program.path("study.toml"), &done).unwrap();
        study(program, &["--on", "slurm", "--remote", &url]).well();
    }
    let login = slurm();
    fs::write(login.path("study.toml"), &done).unwrap();
    study(&login, &["--on", "slurm", "--remote", &url]).well();
    assert_eq!(table(&login), table(&node));
    assert_eq!(read(&login, "sbatch.log"), "", "nothing is left to submit");
}

#[test]
fn a_profile_is_read_and_options_come_first() {
    let program = slurm();
    let text = "partition = \"long\"\naccount = \"fluid\"\nmemory = \"3G\"\ncores = 4\n\
                options = [\"--qos=low\"]\nsetup = [\"export GREETING='good day'\"]\n";
    fs::write(program.path("cluster.toml"), text).unwrap();
    fs::write(program.path("later"), "").unwrap();
    let on = ["--on", "slurm", "--profile", "cluster.toml", "--cores", "1"];
    study(&program, &on).well();
    let script = read(&program, "artifacts/latest/study/batch/job.sh");
    for line in [
        "#SBATCH --partition=long",
        "#SBATCH --account=fluid",
        "#SBATCH --mem=3000M",
        "#SBATCH --cpus-per-task=1",
        "#SBATCH --time=10",
        "#SBATCH --qos=low",
        "export GREETING='good day'",
    ] {
        assert!(
            script.lines().any(|found| found == line),
            "{line}: {script}"
        );
    }
    for (old, new, word) in [("cores", "coers", "coers"), ("3G", "3 pints", "3 pints")] {
        fs::write(program.path("cluster.toml"), text.replace(old, new)).unwrap();
        study(&program, &["--on", "slurm", "--profile", "cluster.toml"]).badly(2, &[word]);
    }
    study(&program, &["--on", "hq", "--partition", "a"]).badly(2, &["no partitions"]);
    let bare = self::program(&[]);
    fs::write(bare.path("study.toml"), STUDY).unwrap();
    let mut command = bare.command(&["study", "study.toml", "--on", "slurm"]);
    let ended = Ended::from(command.env("PATH", bare.path("bin")).output().unwrap());
    ended.badly(2, &["`sbatch`", "submitted"]);
    study(&bare, &["--point", "5"]).badly(2, &["points are 1 to 4"]);
}

/// The script of a task: who is killed starts again, who is cancelled does not.
#[test]
fn a_killed_task_is_queued_again_and_a_cancelled_one_is_not() {
    let program = slurm();
    fs::write(program.path("later"), "").unwrap();
    study(&program, &["--on", "slurm"]).well();
    let script = read(&program, "artifacts/latest/study/batch/job.sh");
    let place = env!("CARGO_BIN_EXE_coronet");
    // A point that takes a while and stops as the program does.
    let point = "trap 'exit 130' TERM\necho $$ > pid\nfor k in {1..100}; do sleep 0.1; done\n";
    fs::write(program.path("point"), point).unwrap();
    fs::write(
        program.path("job.sh"),
        script.replace(place, "bash ./point"),
    )
    .unwrap();
    for (signal, to_point, again) in [
        ("KILL", true, true),
        ("TERM", true, true),
        ("USR1", false, true),
        ("TERM", false, false),
    ] {
        let _ = fs::remove_file(program.path("scontrol.log"));
        let _ = fs::remove_file(program.path("pid"));
        let mut child = std::process::Command::new("bash")
            .arg("job.sh")
            .current_dir(program.folder.path())
            .env(
                "PATH",
                format!("{}:/usr/bin:/bin", program.path("bin").display()),
            )
            .env("SLURM_ARRAY_JOB_ID", "7")
            .env("SLURM_ARRAY_TASK_ID", "2")
            .spawn()
            .unwrap();
        while read(&program, "pid").trim().is_empty() {
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        let pid = read(&program, "pid").trim().to_string();
        let job = child.id().to_string();
        let send = |to: &str| {
            let sent = std::process::Command::new("kill")
                .args(["-s", signal, to])
                .status();
            assert!(sent.unwrap().success());
        };
        send(if to_point { &pid } else { &job });
        if signal == "TERM" && !to_point {
            // Slurm signals all processes of a job.
            send(&pid);
        }
        let code = child.wait().unwrap().code();
        assert_eq!(
            code,
            Some(if signal == "KILL" { 137 } else { 130 }),
            "{signal}"
        );
        let said = read(&program, "scontrol.log");
        let expected = if again { "requeue 7_2\n" } else { "" };
        assert_eq!(said, expected, "{signal} to point: {to_point}");
    }
}

#[test]
fn a_study_of_the_same_name_is_refused() {
    let program = slurm();
    fs::write(program.path("later"), "").unwrap();
    fs::write(program.path("queue"), "7 1 RUNNING\n7 2 RUNNING\n").unwrap();
    study(&program, &["--on", "slurm"]).well();
    fs::create_dir(program.path("b")).unwrap();
    for name in ["study.toml", "tiny.toml"] {
        fs::copy(program.path(name), program.path("b").join(name)).unwrap();
    }
    // A copy in another folder is the same study.
    study_of(&program, "b/study.toml", &["--on", "slurm", "--look"]).well();
    let text = read(&program, "study.toml") + "# another\n";
    fs::write(program.path("b/study.toml"), text).unwrap();
    let slurm = ["--on", "slurm"];
    for more in [
        &slurm[..],
        &["--on", "slurm", "--look"],
        &["--on", "slurm", "--cancel"],
        &[],
    ] {
        let ended = study_of(&program, "b/study.toml", more);
        ended.badly(2, &["b/study.toml", "has the name of", "--artifacts"]);
    }
    assert_eq!(read(&program, "scancel.log"), "");
}

#[test]
fn what_was_refused_for_its_memory_runs_with_more() {
    let program = slurm();
    study(&program, &["--on", "slurm"]).well();
    let name = "artifacts/latest/study/batch/failed-2.json";
    let mut failure: Value = serde_json::from_str(&read(&program, name)).unwrap();
    failure["code"] = 2.into();
    failure["memory"] = 1e9.into();
    fs::write(program.path(name), failure.to_string()).unwrap();
    let submitted = || read(&program, "sbatch.log").lines().count();
    study(&program, &["--on", "slurm", "--memory", "900M"]).well();
    assert_eq!(submitted(), 1);
    study(&program, &["--on", "slurm", "--memory", "2G"]).well();
    assert_eq!(submitted(), 2);
    let script = read(&program, "artifacts/latest/study/batch/job.sh");
    assert!(script.contains("#SBATCH --array=2\n"), "{script}");
}
