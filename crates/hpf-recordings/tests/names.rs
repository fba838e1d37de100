//! Reading demonstrations: what is right is read, and every mistake has its line, its column and its remedy.

use hpf_recordings::{MAX_MISTAKES, Mapping, Mistake, read};
use hpf_sim::Demonstration;
use hpf_sim::task::Unit;

const ROWS: &str = "0,0\n1,1\n2,2\n3,3\n4,4\n";

fn parse(text: &str) -> Result<Demonstration, Vec<Mistake>> {
    read(text.as_bytes(), &Mapping::default()).map(|read| read.recording).map_err(|refusal| refusal.mistakes)
}

#[track_caller]
fn refused(text: &str, expected: &[&str]) {
    let found = parse(text).unwrap_err();
    let told: Vec<String> = found.iter().map(ToString::to_string).collect();
    for words in expected {
        assert!(told.iter().any(|line| line.contains(words)), "`{words}` is missing from {told:#?}");
    }
    assert_eq!(told.len(), expected.len(), "{told:#?}");
}

#[test]
fn columns_of_every_kind_are_read_in_any_order() {
    let text = "# made by hand\nx_force_n,time_s,x_m,j_rad,j_torque_nm,x_emg\n\
                1,10,0,5,2,-1\n1,10.5,1,5,2,-1\n1,11,2,5,2,-1\n1,12,3,5,2,-1\n1,13,4,5,2,-1\n";
    let found = parse(text).unwrap();
    assert_eq!(found.time, [0.0, 0.5, 1.0, 2.0, 3.0], "time starts at zero");
    assert_eq!(
        found.axes.iter().map(|axis| (axis.name.as_str(), axis.unit)).collect::<Vec<_>>(),
        [("x", Unit::M), ("j", Unit::Rad)]
    );
    assert_eq!(found.axes[0].position, [0.0, 1.0, 2.0, 3.0, 4.0]);
    assert_eq!(found.axes[0].force.as_deref(), Some(&[1.0; 5][..]));
    assert_eq!(found.axes[0].emg.as_deref(), Some(&[-1.0; 5][..]));
    assert_eq!(found.axes[1].force.as_deref(), Some(&[2.0; 5][..]));
    assert_eq!(found.axes[1].stiffness, None);
}

#[test]
fn the_trajectory_of_a_run_is_a_demonstration() {
    let header = "time_s,phase,y_reference_m,y_reference_velocity_m_s,y_position_m,y_velocity_m_s,y_force_n,\
                  y_stiffness_n_m,y_damping_n_s_m,deflection_m,deviation_m,contact_force_n";
    let rows: String = (0..5).map(|i| format!("{i},1,2,3,4,5,6,7,8,9,10,11\n")).collect();
    let found = parse(&format!("{header}\n{rows}")).unwrap();
    let [axis] = found.axes.as_slice() else { panic!("one axis: {found:?}") };
    assert_eq!(axis.name, "y");
    assert_eq!((axis.position[0], axis.reference.as_ref().unwrap()[0]), (4.0, 2.0));
    assert_eq!((axis.stiffness.as_ref().unwrap()[0], axis.damping.as_ref().unwrap()[0]), (7.0, 8.0));
}

#[test]
fn headers_are_refused_by_their_columns() {
    let header = |header: &str, expected: &[&str]| refused(&format!("{header}\n{ROWS}"), expected);
    header("t,x_m", &["1: there is no column `time_s`", "1: column `t`: unknown column"]);
    header("time_s,x_m,x_stifness_n_m", &["column `x_stifness_n_m`: unknown column, did you mean `x_stiffness_n_m`?"]);
    header("time_s,x_m,colour", &["column `colour`: unknown column; columns are time_s and"]);
    header("time_s,x", &["column `x`: unknown column", "there is no position column, such as x_m or x_rad"]);
    header("time_s,x_m,x_m", &["column `x_m`: the header has this column twice"]);
    header("time_s,x_m,x_position_m", &["column `x_position_m`: axis `x` has two position columns"]);
    header("time_s,x_m,y_force_n", &["column `y_force_n`: axis `y` has no position column, y_m or y_rad"]);
    header(
        "time_s,x_m,x_torque_nm",
        &["column `x_torque_nm`: axis `x` is in m, this column belongs to the other unit"],
    );
    let many: Vec<String> = (0..8).map(|i| format!("a{i}_m")).collect();
    header(&format!("time_s,{}", many.join(",")), &["8 axes; at most 7 are allowed"]);
    refused("", &["1: the file is empty"]);
    refused(" \n\n", &["1: the file is empty"]);
}

#[test]
fn rows_are_refused_by_line_and_column() {
    let rows = |rows: &str, expected: &[&str]| refused(&format!("# a comment\ntime_s,x_m\n{rows}"), expected);
    rows("0,0\n1,1\n1,2\n3,3\n4,4\n", &["5: column `time_s`: the time 1 stands twice"]);
    rows("0,0\n2,1\n1,2\n3,3\n4,4\n", &["5: column `time_s`: the time falls from 2 to 1"]);
    rows(
        "0,0\n1,nan\n2,inf\n3,3\n4,4\n",
        &["4: column `x_m`: nan is not finite", "5: column `x_m`: inf is not finite"],
    );
    rows(
        "0,0\n1,one\n2,\n3,3\n4,4\n",
        &["4: column `x_m`: `one` is no number", "5: column `x_m`: the value is missing"],
    );
    rows("0,0\n1\n2,2,2\n3,3\n4,4\n", &["4: 1 values for the 2 columns", "5: 3 values for the 2 columns"]);
    rows("0,0\n1,1\n2,2\n3,3\n", &["6: 4 samples; at least 5 and at most 1000001 are needed"]);
    rows("", &["2: 0 samples"]);
    rows("0,0\n# a pause\n\n1,bad\n2,2\n3,3\n4,4\n", &["6: column `x_m`: `bad` is no number"]);
    let stiffness = "time_s,x_m,x_stiffness_n_m\n0,0,100\n1,1,0\n2,2,-3\n3,3,1\n4,4,1\n";
    refused(stiffness, &["3: column `x_stiffness_n_m`: must be above 0, not 0", "4: column `x_stiffness_n_m`: must"]);
}

#[test]
fn no_more_mistakes_are_told_than_one_reads() {
    let rows: String = (0..100).map(|i| format!("{i},bad\n")).collect();
    assert_eq!(parse(&format!("time_s,x_m\n{rows}")).unwrap_err().len(), MAX_MISTAKES);
}

#[test]
fn a_byte_order_mark_and_spaces_are_no_mistake() {
    let text = format!("\u{feff}time_s , x_m\n{}", ROWS.replace(',', " , "));
    assert!(parse(&text).is_ok(), "{:?}", parse(&text));
}
