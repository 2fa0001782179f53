//! Studies on HyperQueue, by a stand-in for its command.

use std::fs;

use crate::batch::{local, program, read, study, table};

const HQ: &str = r#"#!/bin/bash
echo "$*" >> hq.log
case "$*" in
*submit*)
    for word in "$@"; do case $word in --array=*) tasks=${word#--array=} ;; esac; done
    [ -e later ] && { echo 7; exit; }
    for task in ${tasks//,/ }; do HQ_TASK_ID=$task bash "${!#}" >> tasks.log 2>&1; done
    echo 7 ;;
*"server info"*) echo "{\"server_uid\": \"$(cat server)\"}" ;;
*"task list 7"*) [ -e later ] && {
        task='"state": "running"'
        list="{\"id\": 1, $task}, {\"id\": 2, $task}, {\"id\": 3, $task}, {\"id\": 4, $task}"
        echo "{\"7\": [$list]}"
        exit; }
    echo '{"7": [{"id": 1, "state": "finished"}, {"id": 2, "state": "failed"}]}' ;;
esac
"#;

#[test]
fn a_study_on_hyperqueue_has_the_table_of_a_local_one() {
    let program = program(&[("hq", HQ)]);
    study(&program, &["--on", "hq", "--time", "1h", "--memory", "2G"]).well();
    assert_eq!(table(&program), local());
    let said = read(&program, "hq.log");
    let first = said.lines().find(|line| line.contains("submit")).unwrap();
    assert!(first.starts_with("--output-mode quiet submit "), "{first}");
    for word in [
        "--array=1,2,3,4",
        "--cpus=1",
        "--resource=mem=2000",
        "--time-limit=1h",
        " -- bash ",
    ] {
        assert!(first.contains(word), "{word}: {first}");
    }
    study(&program, &["--on", "hq"]).well();
    assert_eq!(read(&program, "hq.log").matches("submit").count(), 1);
}

/// A server that was started anew begins with job 1 again.
#[test]
fn jobs_of_another_server_are_not_those_of_the_study() {
    let program = program(&[("hq", HQ)]);
    fs::write(program.path("later"), "").unwrap();
    fs::write(program.path("server"), "first").unwrap();
    let submitted = || read(&program, "hq.log").matches(" submit ").count();
    for (server, times) in [("first", 1), ("first", 1), ("second", 2)] {
        fs::write(program.path("server"), server).unwrap();
        study(&program, &["--on", "hq"]).well();
        assert_eq!(submitted(), times, "{server}");
    }
    // What waits keeps its own script.
    for number in 1..=2 {
        read(
            &program,
            &format!("artifacts/latest/study/batch/job-{number}.sh"),
        );
    }
    fs::write(program.path("server"), "third").unwrap();
    study(&program, &["--on", "hq", "--cancel"]).well();
    assert!(!read(&program, "hq.log").contains("cancel"));
}
