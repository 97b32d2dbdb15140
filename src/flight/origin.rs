//! The program and the machine that made a recording.

use serde::{Deserialize, Serialize};

use crate::engine::engine_version;

/// Program and machine that made a recording. Another one may compute other last bits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Origin {
    /// Version of this crate.
    pub library: String,
    /// Version of the engine. Builds of one version may differ.
    pub engine: String,
    /// Architecture and operating system.
    pub target: String,
    /// Instruction sets by which the engine and the system's mathematical library select code.
    pub processor: String,
}

impl Origin {
    /// Returns the origin of recordings of this process.
    pub fn here() -> Self {
        Self {
            library: env!("CARGO_PKG_VERSION").to_owned(),
            engine: engine_version().to_string(),
            target: format!("{} {}", std::env::consts::ARCH, std::env::consts::OS),
            processor: processor(),
        }
    }

    fn parts(&self) -> [&str; 4] {
        [&self.library, &self.engine, &self.target, &self.processor]
    }

    /// Returns the parts that differ in this process, as sentences.
    pub fn differences(&self) -> Vec<String> {
        let names = ["this crate", "the engine", "the target", "the processor"];
        let here = Self::here();
        let parts = names.into_iter().zip(self.parts().into_iter().zip(here.parts()));
        let differing = parts.filter(|(_, (recorded, present))| recorded != present);
        differing.map(|(name, (recorded, present))| format!("{name} was {recorded}, here it is {present}")).collect()
    }
}

fn processor() -> String {
    #[cfg(target_arch = "x86_64")]
    let features = {
        macro_rules! present {
            ($($feature:tt)*) => { [$((is_x86_feature_detected!($feature), $feature)),*] };
        }
        present!("sse4.1" "avx" "fma" "avx2" "avx512f")
    };
    #[cfg(not(target_arch = "x86_64"))]
    let features: [(bool, &str); 0] = [];
    features.into_iter().filter_map(|(is_present, name)| is_present.then_some(name)).collect::<Vec<_>>().join(" ")
}
