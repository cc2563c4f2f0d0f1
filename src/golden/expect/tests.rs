use super::*;
use glam::Vec3;

/// Two by one pixels.
fn levels(left: u8, right: u8) -> EncodedImage {
    EncodedImage::of_bytes(2, 1, vec![left, left, left, right, right, right]).unwrap()
}

fn linear(right: f32) -> Image {
    Image::new(2, 1, vec![Vec3::ONE, Vec3::splat(right)]).unwrap()
}

#[test]
fn levels_and_linear_values_are_held_against_their_files() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| {
        Expected::new(folder.path().join("golden").join(name))
            .failures_in(folder.path().join("out"))
    };
    let png = at("a.png");
    let missing = png.check_levels(&levels(10, 20)).unwrap_err();
    let GoldenError::Missing { actual, .. } = &missing else {
        panic!("{missing:?}");
    };
    assert!(actual.exists(), "{missing:?}");
    assert!(missing.to_string().contains("RELUME_BLESS=1"), "{missing}");

    write_file(&png.golden, &encode_png(&levels(10, 20)).unwrap()).unwrap();
    png.check_levels(&levels(10, 20)).unwrap();
    let differs = png.check_levels(&levels(10, 23)).unwrap_err();
    let GoldenError::Differs { strip, passing, .. } = &differs else {
        panic!("{differs:?}");
    };
    assert!(
        strip.exists() && passing.contains("max_channel_difference = 3"),
        "{differs}"
    );
    let limits = Limits {
        max_channel_difference: Some(3.0),
        ..Limits::default()
    };
    png.clone()
        .within(limits)
        .check_levels(&levels(10, 23))
        .unwrap();

    let exr = at("a.exr");
    let kinds = exr.check_levels(&levels(1, 2)).unwrap_err();
    assert!(
        matches!(kinds, GoldenError::Check(CheckError::Judge(_))),
        "{kinds:?}"
    );
    let picture = Picture {
        linear: &linear(0.25),
        encoded: &levels(1, 2),
    };
    crate::output::write_picture(&exr.golden, picture).unwrap();
    exr.check_linear(&linear(0.25)).unwrap();
    assert!(exr.check_linear(&linear(0.26)).is_err());
}

#[test]
fn faulty_frames_and_unreadable_goldens_fail() {
    let folder = tempfile::tempdir().unwrap();
    let golden = folder.path().join("a.png");
    let expected = Expected::new(&golden).failures_in(folder.path());
    write_file(&golden, &encode_png(&levels(0, 0)).unwrap()).unwrap();
    for (one, fault) in [
        (levels(0, 0), FrameFault::Black),
        (levels(9, 9), FrameFault::Constant),
    ] {
        let error = expected.check_levels(&one).unwrap_err();
        let is_it = matches!(&error, GoldenError::Faulty { fault: found, .. } if *found == fault);
        assert!(is_it, "{error:?}");
    }
    std::fs::write(&golden, b"no image").unwrap();
    let error = expected.check_levels(&levels(1, 2)).unwrap_err();
    assert!(
        matches!(&error, GoldenError::Check(it) if it.is_io()),
        "{error:?}"
    );
}

/// Folder of [`blessing`]'s golden, which it is given by the test below.
const FOLDER: &str = "RELUME_TEST_FOLDER";

#[test]
#[ignore = "is run by the next test, in a process with the environment variable"]
fn blessing() {
    let Some(folder) = std::env::var_os(FOLDER).map(PathBuf::from) else {
        return;
    };
    let expected = Expected::new(folder.join("golden/a.png"));
    let blessed = expected.check_levels(&levels(1, 2)).unwrap_err();
    assert!(
        matches!(blessed, GoldenError::Blessed { .. }),
        "{blessed:?}"
    );
    expected.check_levels(&levels(1, 2)).unwrap();
    let black = expected.check_levels(&levels(0, 0)).unwrap_err();
    assert!(matches!(black, GoldenError::Faulty { .. }), "{black:?}");
    let masked = expected.masked_by(folder.join("absent.png"));
    let error = masked.check_levels(&levels(1, 3)).unwrap_err();
    assert!(matches!(error, GoldenError::Check(_)), "{error:?}");
}

#[test]
fn the_environment_lets_goldens_be_written_and_fails() {
    let folder = tempfile::tempdir().unwrap();
    let mut this = std::process::Command::new(std::env::current_exe().unwrap());
    this.args(["--ignored", "--exact", "golden::expect::tests::blessing"]);
    this.env(FOLDER, folder.path()).env(BLESS_VARIABLE, "1");
    let output = this.output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert!(folder.path().join("golden/a.png").exists());
}
