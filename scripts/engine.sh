# Sourced by the other scripts. Selects the engine that scripts/setup has installed in
# target/engine, unless MUJOCO_DIR names another.
engine_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/target/engine
if [ -z "${MUJOCO_DIR-}" ] && [ -e "$engine_folder/mujoco/include/mujoco/mujoco.h" ]; then
  export MUJOCO_DIR=$engine_folder/mujoco
fi
