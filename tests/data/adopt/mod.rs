//! Simulations that adopt edited models: the state of surviving elements, and unchanged models.

mod cases;
#[cfg(engine_since = "3.2.0")]
mod copies;
mod other_values;
mod random;
mod unchanged;

/// Delay of an actuator and of a sensor, with engines that have them.
const DELAY: &str = if cfg!(engine_since = "3.5.0") { " nsample='4' delay='.006'" } else { "" };

/// Returns a model with activations, delays, tendons, contacts, equality constraints and a mocap
/// body.
fn mixed_text() -> String {
    format!(
        "<mujoco><size nuserdata='5' njmax='500' nconmax='100'/><worldbody>
           <geom type='plane' size='5 5 .1'/>
           <body name='hand' mocap='true' pos='0 0 1'><geom size='.05' contype='0' conaffinity='0'/></body>
           <body name='held' pos='0 0 .9'><freejoint/><geom type='box' size='.05 .06 .07'/></body>
           <body pos='1 0 .5'><joint name='a' axis='0 1 0'/><geom type='capsule' size='.04' fromto='0 0 0 .2 0 0'/>
             <body pos='.2 0 0'><joint name='b' axis='0 1 0' damping='.1'/><joint name='s' type='slide' axis='0 0 1'/>
               <geom size='.05'/><site name='tip'/></body></body>
           <body pos='-1 0 .5'><joint type='ball' damping='.01'/><geom type='box' size='.1 .05 .02' pos='.1 0 0'/></body>
           <body name='tied' pos='-1 1 .5'><freejoint/><geom size='.1'/></body>
           <site name='hook' pos='1 0 1'/>
         </worldbody>
         <tendon><spatial name='rope' range='0 .6' limited='true'><site site='hook'/><site site='tip'/></spatial></tendon>
         <equality><weld body1='hand' body2='held'/><joint joint1='a' joint2='b'/><connect body1='tied' anchor='0 0 1'/></equality>
         <actuator>
           <motor joint='a'{DELAY}/><position joint='s' kp='20'/>
           <general joint='b' dyntype='filter' dynprm='.1'/><general tendon='rope' dyntype='integrator' actlimited='true' actrange='-1 1'/>
         </actuator>
         <sensor><jointpos joint='a'{DELAY}/><framepos objtype='body' objname='held'/><tendonpos tendon='rope'/></sensor></mujoco>"
    )
}

/// Returns numbers that count up.
fn numbers(count: usize, first: f64) -> Vec<f64> {
    (0..count).map(|number| first + number as f64).collect()
}
