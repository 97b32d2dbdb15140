//! Servers for the tests of `scripts/try-html`.

use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

use mujoco_safe::html::HtmlOptions;
use mujoco_safe::live::{LiveOptions, LivePage};
use mujoco_safe::{Batch, Data, MatrixView, MatrixViewMut, Model, ZeroController, sample};

use crate::soft::SOFT;

/// Runs until the file `stop` is in the folder.
#[test]
#[ignore = "scripts/try-html runs it"]
fn pages_are_served() {
    let folder = PathBuf::from(std::env::var_os("HTML_PAGES").expect("HTML_PAGES is the folder for the pages"));
    let stop = folder.join("stop");
    let hostile = "&lt;img src=x onerror=globalThis.hacked=1>";
    let hostile = Model::from_xml_str(&format!(
        "<mujoco><worldbody><light pos='0 0 3'/><body name=\"{hostile}\"><joint name=\"{hostile}\"/>
           <geom name=\"{hostile}\" size='.3' pos='0 0 -.2' rgba='.8 .3 .2 1'/></body></worldbody>
           <actuator><motor name=\"{hostile}\" joint=\"{hostile}\"/></actuator></mujoco>"
    ))
    .unwrap();
    let serve = |name: &str, mut data: Data, options: HtmlOptions| {
        let mut page = LivePage::bind(data.model(), &LiveOptions::default().with_page(options)).unwrap();
        std::fs::write(folder.join(format!("{name}.url")), page.url()).unwrap();
        let start = Instant::now();
        while !stop.exists() && start.elapsed() < Duration::from_secs(900) {
            page.run_for(Duration::from_millis(200), &mut data, &mut ZeroController).ok();
        }
    };
    thread::scope(|scope| {
        scope.spawn(|| {
            let mut data = Data::new(sample::humanoid()).unwrap();
            data.reset_to_key("stand").unwrap();
            serve("live", data, HtmlOptions::default().with_title("Live humanoid"));
        });
        scope.spawn(|| {
            let data = Data::new(Model::from_xml_str(SOFT).unwrap()).unwrap();
            serve("soft", data, HtmlOptions::default().with_title("Live tendon and skin").with_camera("front"));
        });
        scope.spawn(|| {
            let mut batch = Batch::new(sample::humanoid(), 16).unwrap().with_chunk(16);
            let options = HtmlOptions::default().with_title("Batch of 16");
            let mut page = LivePage::bind(batch.model(), &LiveOptions::default().with_page(options)).unwrap();
            std::fs::write(folder.join("batch.url"), page.url()).unwrap();
            let mut step = 0_u32;
            let start = Instant::now();
            while !stop.exists() && start.elapsed() < Duration::from_secs(900) {
                if page.exchange_batch(&mut batch).unwrap().advance {
                    step += 1;
                    let control = |index: usize| 0.5 * (0.02 * f64::from(step) + index as f64).sin();
                    let policy = |_: MatrixView<'_>, controls: &mut MatrixViewMut<'_>| {
                        for (index, control_of) in controls.as_mut_slice().iter_mut().enumerate() {
                            *control_of = control(index);
                        }
                    };
                    batch.step(policy).unwrap();
                }
                page.wait(Duration::from_millis(5));
            }
        });
        scope.spawn(|| {
            let options = HtmlOptions::default().with_title("<script>globalThis.hacked = 1</script>");
            serve("hostile", Data::new(hostile).unwrap(), options);
        });
    });
}
