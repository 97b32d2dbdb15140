//! A model with a tendon and a skin, for the tests of pages in browsers.

/// A tendon and a skin in front of a camera.
pub const SOFT: &str = "<mujoco><statistic extent='1' center='.2 0 .2'/>
  <asset><skin name='skin' rgba='.2 .6 .9 1' vertex='0 0 0  0 0 .2  .3 0 0  .3 .05 .2  .5 0 0  .5 0 .2'
      face='0 2 1  1 2 3  2 4 3  3 4 5'>
    <bone body='one' bindpos='0 0 0' bindquat='1 0 0 0' vertid='0 1 2 3' vertweight='1 1 .5 .5'/>
    <bone body='two' bindpos='.25 0 0' bindquat='1 0 0 0' vertid='2 3 4 5' vertweight='.5 .5 1 1'/></skin></asset>
  <worldbody><light pos='.2 -2 3' dir='0 .5 -1' castshadow='false'/>
    <camera name='front' pos='.2 -1.2 .3' xyaxes='1 0 0 0 .1 1'/>
    <geom type='plane' size='2 2 .1' pos='0 0 -.5' rgba='.7 .7 .7 1'/>
    <site name='anchor' pos='.5 0 .6'/>
    <body name='one'><joint axis='0 1 0' damping='.02'/><geom size='.04' rgba='1 0 0 1'/>
      <body name='two' pos='.25 0 0'><joint axis='0 1 0' damping='.02'/><geom size='.04' pos='.25 0 0' rgba='1 0 0 1'/>
        <site name='tip' pos='.25 0 0'/></body></body></worldbody>
  <tendon><spatial name='rope' width='.015' rgba='1 .8 0 1'><site site='anchor'/><site site='tip'/></spatial></tendon></mujoco>";
