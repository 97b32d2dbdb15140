//! The example `learn_gait`: its policies and its search.

use std::sync::Arc;

use mujoco_safe::Matrix;
use mujoco_safe::environment::HalfCheetah;
use mujoco_safe::rayon::ThreadPoolBuilder;

use crate::Random;
use crate::policy::Policy;
use crate::search::Search;

#[test]
fn policies_load_as_they_were_saved() {
    let mut random = Random::new(1);
    let weights = Matrix::from(&random.matrix(6, 17));
    let [mean, deviation] = [(); 2].map(|()| random.vector(17).as_slice().to_vec());
    let policy = Policy { weights, mean, deviation };
    let scratch = tempfile::tempdir().unwrap();
    let path = scratch.path().join("policy.json");
    policy.save(&path).unwrap();
    assert_eq!(Policy::load(&path, 6, 17).unwrap(), policy);
    let message = Policy::load(&path, 3, 11).unwrap_err().to_string();
    assert!(message.ends_with("policy.json is not a policy with 3 controls and 11 observations"), "{message}");
}

#[test]
#[ignore = "takes a minute"]
fn the_search_learns_and_is_the_same_in_any_number_of_threads() {
    let model = Arc::new(HalfCheetah::model());
    let search = |threads: usize, iterations: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut search = Search::new(&model, 1).unwrap();
            let curve: Vec<f64> = (0..iterations).map(|_| search.iterate().unwrap()).collect();
            (curve, search.policy().clone())
        })
    };
    assert_eq!(search(1, 3), search(3, 3));
    let (curve, _) = search(2, 40);
    assert!(curve[0].abs() < 20.0 && curve[30..].iter().any(|&value| value > 500.0), "{curve:?}");
}
