//! Elements that survive while some of their values start anew, and plastic deformation.

#[cfg(engine_since = "3.5.0")]
use mujoco_safe::StateSpec;
#[cfg(engine_since = "3.5.0")]
use mujoco_safe::kind::Kind;
#[cfg(engine_since = "3.5.0")]
use mujoco_safe::spec::Spec;
use mujoco_safe::{Data, Model};

#[cfg(engine_since = "4.0.0")]
use super::numbers;

#[cfg(engine_since = "3.5.0")]
#[test]
fn another_number_of_samples_starts_a_new_buffer() {
    let mut spec = Spec::from_xml_str(&super::mixed_text()).unwrap();
    let mut data = Data::new(spec.compile().unwrap()).unwrap();
    data.ctrl_mut().fill(0.5);
    data.step_n(20).unwrap();
    let before = data.state(StateSpec::HISTORY);
    let [actuator, sensor] =
        [data.model().actuator_historyadr()[0], data.model().sensor_historyadr()[0]].map(|at| at as usize);
    let id = spec.ids::<mujoco_safe::kind::Actuator>()[0];
    spec.edit(id).set("nsample", 6).unwrap();
    let adoption = data.adopt(spec.compile().unwrap()).unwrap();
    assert_eq!(
        adoption.reset.iter().map(|element| (element.kind, element.index)).collect::<Vec<_>>(),
        [(Kind::Actuator, 0)]
    );
    let (model, after) = (data.model(), data.state(StateSpec::HISTORY));
    let place = model.sensor_historyadr()[0] as usize;
    assert_eq!(after[place..][..10], before[sensor..][..10]);
    let fresh = Data::new(model).unwrap().state(StateSpec::HISTORY);
    let place = model.actuator_historyadr()[0] as usize;
    assert_eq!(after[place..][..14], fresh[place..][..14]);
    assert_ne!(after[place..][..10], before[actuator..][..10]);
    data.step_n(20).unwrap();
}

#[cfg(engine_since = "3.5.0")]
#[test]
fn a_new_sensor_with_an_interval_takes_samples_until_it_has_the_time_of_the_simulation() {
    let text = |sensor: &str| {
        format!(
            "<mujoco><worldbody><body><joint name='j'/><geom size='.1' pos='.1 0 0'/></body></worldbody><sensor>{sensor}</sensor></mujoco>"
        )
    };
    let model = |sensor: &str| Model::from_xml_str(&text(sensor)).unwrap();
    let mut data = Data::new(model("")).unwrap();
    data.set_time(1.0);
    data.adopt(model("<jointpos joint='j' nsample='4' delay='.002' interval='.1'/>")).unwrap();
    let mut samples = |steps: usize| {
        let steps = (0..steps).filter(|_| {
            let before = data.state(StateSpec::HISTORY);
            data.step().unwrap();
            data.state(StateSpec::HISTORY) != before
        });
        steps.count()
    };
    assert_eq!(samples(10), 10);
    assert!((1..=3).contains(&samples(100)));
}

#[test]
fn actuators_with_other_activations_are_listed() {
    let model = |dynamics: &str| {
        Model::from_xml_str(&format!(
            "<mujoco><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody>
               <actuator><motor name='m' joint='j'/><general name='a' joint='j' {dynamics}/></actuator></mujoco>"
        ))
        .unwrap()
    };
    let [plain, filtered] = ["", "dyntype='filter' dynprm='.1'"].map(model);
    for (from, to) in [(&plain, &filtered), (&filtered, &plain)] {
        let mut data = Data::new(from.clone()).unwrap();
        data.ctrl_mut().copy_from_slice(&[1.0, 2.0]);
        let adoption = data.adopt(to.clone()).unwrap();
        assert_eq!((adoption.lost, adoption.new), (vec![], vec![]));
        assert_eq!(adoption.reset.iter().map(ToString::to_string).collect::<Vec<_>>(), ["actuator 'a'"]);
        assert_eq!(data.ctrl(), [1.0, 2.0]);
    }
}

#[cfg(engine_since = "4.0.0")]
#[test]
fn plastic_deformations_follow_their_elements() {
    let arm = |name: &str| {
        format!(
            "<body name='{name}' pos='0 0 1'><joint name='{name}' axis='0 1 0' stiffness='50' springyield='5'/>
               <geom size='.1' pos='.5 0 0'/><site name='{name}' pos='.5 0 0'/></body>"
        )
    };
    let rope = |name: &str| {
        format!(
            "<spatial name='{name}' stiffness='100' springyield='.1'><site site='hook'/><site site='{name}'/></spatial>"
        )
    };
    let model = |names: &[&str]| {
        let arms: String = names.iter().map(|name| arm(name)).collect();
        let ropes: String = names.iter().map(|name| rope(name)).collect();
        let text = format!(
            "<mujoco><worldbody><site name='hook' pos='0 0 2'/>{arms}
               <flexcomp name='cloth' type='grid' dim='2' count='3 3 1' spacing='.1 .1 .1' radius='.02' mass='1'>
                 <elasticity young='1e4' poisson='.2' thickness='.01' elastic2d='both' yield='.01 .01'/></flexcomp>
             </worldbody><tendon>{ropes}</tendon></mujoco>"
        );
        Model::from_xml_str(&text).unwrap()
    };
    let parts = |data: &Data| -> Vec<(i32, i32)> {
        let model = data.model();
        let ends = [model.jnt_plasticadr(), model.tendon_plasticadr(), model.flex_plasticadr()].concat();
        let mut ends: Vec<i32> = ends.into_iter().filter(|address| *address >= 0).collect();
        ends.push(model.state_size(StateSpec::PLASTIC) as i32);
        ends.sort_unstable();
        ends.windows(2).map(|pair| (pair[0], pair[1])).collect()
    };
    let mut data = Data::new(model(&["a", "b"])).unwrap();
    let count = data.model().state_size(StateSpec::PLASTIC);
    data.set_state(StateSpec::PLASTIC, &numbers(count, 1.0)).unwrap();
    let old = data.clone();
    data.adopt(model(&["c", "b"])).unwrap();
    let (before, after) = (old.state(StateSpec::PLASTIC), data.state(StateSpec::PLASTIC));
    let [from, to] = [&old, &data].map(parts);
    assert_eq!(from, to);
    let fresh = Data::new(data.model()).unwrap().state(StateSpec::PLASTIC);
    let is_new = |start: i32| {
        let model = data.model();
        model.jnt_plasticadr()[0] == start || model.tendon_plasticadr()[0] == start
    };
    assert_eq!(from.len(), 5, "two joints, two tendons and a flex");
    for (start, end) in from {
        let range = start as usize..end as usize;
        let expected = if is_new(start) { &fresh } else { &before };
        assert_eq!(after[range.clone()], expected[range]);
    }
}
