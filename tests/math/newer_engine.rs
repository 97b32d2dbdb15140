//! Functions that 2.2.2 lacks, against the Python module of MuJoCo 3.1.6, from which the numbers
//! were recorded.

use mujoco_safe::Matrix;
use mujoco_safe::math::{self, BandShape, BoxQp, BoxQpStatus};

use crate::assert_near;

/// The lower triangle with `nband` of 2 and one dense row.
const FULL: [[f64; 5]; 5] = [
    [4.0, 1.0, 0.0, 0.0, 0.5],
    [1.0, 5.0, -1.0, 0.0, 0.25],
    [0.0, -1.0, 6.0, 2.0, -0.5],
    [0.0, 0.0, 2.0, 7.0, 1.0],
    [0.5, 0.25, -0.5, 1.0, 8.0],
];

#[test]
fn band_matrices_and_factors_equal_the_newer_engine() {
    let shape = BandShape::new(5, 2, 1).unwrap();
    let mut band = vec![0.0; shape.len()];
    math::dense2band(&mut band, &FULL, shape).unwrap();
    assert_eq!(band, [0.0, 4.0, 1.0, 5.0, -1.0, 6.0, 2.0, 7.0, 0.5, 0.25, -0.5, 1.0, 8.0]);
    assert_eq!([0, 1, 2, 3, 4].map(|i| shape.band_diag(i)), [1, 3, 5, 7, 12]);

    let mut res = Matrix::zeros(1, 5);
    math::band_mul_mat_vec(&mut res, &band, &[[1.0, 2.0, 3.0, 4.0, 5.0]], shape, math::BandKind::Symmetric).unwrap();
    assert_near(res.as_slice(), &[8.5, 9.25, 21.5, 39.0, 43.5], 1e-14);

    let smallest = math::chol_factor_band(&mut band, shape, 0.1, 0.2).unwrap().unwrap();
    assert_near(&[smallest], &[4.9], 1e-14);
    let factor = [
        0.0,
        2.213_594_362_117_865_5,
        0.451_753_951_452_625_65,
        2.428_151_224_151_193_3,
        -0.411_835_963_943_954_55,
        2.670_279_224_875_622_4,
        0.748_985_342_569_617_2,
        2.817_626_830_617_545,
        0.225_876_975_726_312_82,
        0.060_934_913_032_523_89,
        -0.177_848_371_409_746_44,
        0.402_184_494_792_523_83,
        3.074_391_666_191_189,
    ];
    assert_near(&band, &factor, 1e-14);
    let mut res = [0.0; 5];
    math::chol_solve_band(&mut res, &band, &[1.0, 2.0, 3.0, 4.0, 5.0], shape).unwrap();
    let expected = [
        0.080_303_602_303_358_45,
        0.361_358_208_714_594_45,
        0.407_165_745_461_858_96,
        0.317_101_203_420_986_36,
        0.490_308_279_997_898_5,
    ];
    assert_near(&res, &expected, 1e-14);
}

#[test]
fn quadratic_programs_equal_the_newer_engine() {
    let h = [[4.0, 1.0, 0.5, -1.0], [1.0, 3.0, -0.5, 0.25], [0.5, -0.5, 2.0, 0.3], [-1.0, 0.25, 0.3, 5.0]];
    let (lower, upper) = ([-1.0, -3.0, -3.0, -0.25], [1.5, 2.0, 10.0, 4.0]);
    let (mut x, mut solver) = ([0.0; 4], BoxQp::new(4));
    let solution = solver.solve(&mut x, &h, &[-8.0, 1.5, -6.0, 2.0], Some(&lower), Some(&upper)).unwrap();
    assert_eq!((solution.status, solution.index), (BoxQpStatus::Solved, [1, 2, 3].as_slice()));
    assert_near(&x, &[1.5, -0.561_748_585_572_843_1, 2.518_011_845_827_439_6, -0.222_993_281_471_004_22], 1e-14);
    let factor = [
        [1.732_050_807_568_877_2, 0.0, 0.0],
        [-0.288_675_134_594_812_87, 1.384_437_310_486_345_7, 0.0],
        [0.144_337_567_297_406_43, 0.246_790_998_825_826_8, 2.217_715_236_355_925_6],
    ];
    for (i, row) in factor.iter().enumerate() {
        assert_near(&solution.factor.row(i)[..=i], &row[..=i], 1e-14);
    }
}

#[test]
fn derivatives_of_quaternions_equal_the_newer_engine() {
    let derivative = math::sub_quat_derivative(&[0.5, -0.5, 0.5, 0.5], &[0.8, 0.0, 0.6, 0.0]);
    let da = [
        0.991_358_697_981_812_6,
        -0.141_622_671_140_259,
        0.081_133_557_012_947_7,
        0.081_133_557_012_947_7,
        0.783_967_449_545_316_8,
        0.783_967_449_545_316_7,
        -0.141_622_671_140_259,
        -0.775_326_147_527_129_5,
        0.783_967_449_545_316_8,
    ];
    assert_near(&derivative.da, &da, 1e-14);
    let db = [0, 3, 6, 1, 4, 7, 2, 5, 8].map(|at| -da[at]);
    assert_near(&derivative.db, &db, 1e-14);

    let derivative = math::quat_integrate_derivative(&[0.3, -1.2, 0.7], 0.8);
    let dquat = [
        0.446_134_095_272_709_53,
        0.343_590_623_224_646_5,
        0.826_383_598_982_518_6,
        -0.550_214_173_174_723_8,
        0.833_553_251_429_104_4,
        -0.049_531_209_046_653_62,
        -0.705_853_194_844_973_6,
        -0.432_590_407_503_526_6,
        0.560_924_956_356_085_7,
    ];
    let dvel = [
        0.807_038_214_750_170_1,
        0.215_112_136_759_813_67,
        0.451_461_570_981_036_23,
        -0.287_097_880_479_957_43,
        0.942_011_484_225_439_7,
        0.023_633_064_592_164_146,
        -0.409_469_887_144_285_67,
        -0.191_599_799_939_166_32,
        0.847_030_294_594_694_5,
    ];
    assert_near(&derivative.dquat, &dquat, 1e-14);
    assert_near(&derivative.dvel, &dvel, 1e-14);
    assert_near(&derivative.dscale, &[0.3, -1.2, 0.7], 1e-14);
}

#[test]
fn euler_angles_equal_the_newer_engine() {
    let quat = [0.232_649_028_605_833_9, -0.435_530_330_865_275_3, -0.306_014_489_582_654, 0.813_967_378_062_913_1];
    assert_near(&math::euler2quat(&[0.3, -1.1, 2.4], "xYz").unwrap(), &quat, 1e-15);
}
