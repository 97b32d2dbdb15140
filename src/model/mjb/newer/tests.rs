//! Tests of the rules for newer engines, on the model with every kind of element and those that 2.2.2 does not have.

use super::super::tests::compile;

/// Compiles the model with every element of 2.2.2, with newer elements.
pub(in super::super) fn every_element(text: &str) -> Vec<u8> {
    let text = INSERTIONS.iter().fold(text.to_owned(), |text, (before, inserted)| {
        assert!(text.contains(before), "every_element.xml has no {before}");
        text.replacen(before, &format!("{inserted}{before}"), 1)
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("every_element.xml");
    std::fs::write(&path, text).unwrap();
    std::fs::write(folder.path().join("grey.png"), include_bytes!("../../../../tests/models/grey.png")).unwrap();
    compile(&path).expect("every_element.xml compiles")
}

/// Texts in the model, and what is inserted before them.
const INSERTIONS: [(&str, &str); 6] = [
    (
        "<mesh name=\"wedge\"",
        "<texture name='grey' type='2d' file='grey.png' nchannel='1'/>
         <texture name='opaque' type='2d' file='grey.png' nchannel='4' colorspace='sRGB'/>
         <material name='layered'><layer role='rgb' texture='checks'/><layer role='normal' texture='dots'/></material>",
    ),
    (
        "</worldbody>",
        "<camera name='pixels' pos='0 -3 1' xyaxes='1 0 0 0 0 1' resolution='4 3' projection='orthographic' output='rgb depth'/>
         <light name='image' type='image' texture='sky'/>
         <body name='several' pos='4 4 1' gravcomp='.5' sleep='never'>
           <joint name='several_x' type='slide' axis='1 0 0' actuatorfrclimited='true' actuatorfrcrange='-1 1' actuatorgravcomp='true'/>
           <geom size='.1'/><geom size='.1' pos='.3 0 0'/><geom type='box' size='.1 .1 .1' pos='.6 0 0'/>
           <geom size='.1' pos='.9 0 0' contype='0' conaffinity='0'/><site name='several_site'/>
         </body>",
    ),
    (
        "<fixed name=\"other_coupling\"",
        "<fixed name='armed' armature='.1' actuatorfrclimited='true' actuatorfrcrange='-1 1'><joint joint='several_x' coef='1'/></fixed>",
    ),
    (
        "</equality>",
        "<connect site1='several_site' site2='anchor' active='false'/><weld site1='several_site' site2='anchor' active='false'/>",
    ),
    (
        "</actuator>",
        "<motor name='late' joint='several_x' nsample='4' delay='.005' interp='linear'/><motor joint='several_x' nsample='2'/>
         <general joint='several_x' dyntype='filterexact' dynprm='.1' actearly='true'/>",
    ),
    (
        "</sensor>",
        "<jointactuatorfrc joint='several_x'/><tendonactuatorfrc tendon='armed'/><camprojection site='tip' camera='pixels'/>
         <distance geom1='ball' geom2='floor' cutoff='1'/><normal geom1='floor' geom2='ball' cutoff='3'/>
         <fromto body1='several' geom2='ball' cutoff='3'/><e_potential/><e_kinetic/>
         <insidesite site='rail' objtype='geom' objname='ball'/>
         <contact geom1='floor' geom2='ball' num='2' data='found force dist normal tangent'/>
         <contact reduce='netforce' subtree1='several'/>
         <jointpos joint='several_x' nsample='3' delay='.004' interp='cubic'/>
         <accelerometer site='tip' nsample='2' interval='.01'/><user dim='2' needstage='pos'/>",
    ),
];
