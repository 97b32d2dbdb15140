// Engine functions that not all versions have and that the shim calls, as weak references: a
// program that runs with an engine of another version than its header then starts, and reports the
// difference between the versions. Otherwise the dynamic loader would end the process at the first
// missing function. No such function is called before the versions are compared.
#ifndef MUJOCO_SYS_OPTIONAL_H_
#define MUJOCO_SYS_OPTIONAL_H_

#if defined(__ELF__)
// Removed since 2.2.2.
#pragma weak mj_findFileVFS
#pragma weak mj_makeEmptyFileVFS
#pragma weak mj_stackAlloc
#pragma weak mju_error_i
#pragma weak mju_rotVecMat
#pragma weak mju_rotVecMatT
#pragma weak mjv_makeConnector
// Added since 2.2.2.
#pragma weak mj_actuatorInputName
#pragma weak mj_addBufferVFS
#pragma weak mj_compile
#pragma weak mj_deleteSpec
#pragma weak mj_flex
#pragma weak mj_freeStack
#pragma weak mj_insideSite
#pragma weak mj_island
#pragma weak mj_loadPluginLibrary
#pragma weak mj_loadTexture
#pragma weak mj_makeM
#pragma weak mj_markStack
#pragma weak mj_parseXMLString
#pragma weak mj_rayFlex
#pragma weak mj_readCtrl
#pragma weak mj_readSensor
#pragma weak mj_resetCtrl
#pragma weak mj_setKeyframe
#pragma weak mj_stackAllocNum
#pragma weak mjp_getPluginAtSlot
#pragma weak mju_mulMatTVec3
#pragma weak mju_mulMatVec3
#pragma weak mju_rayFlex
#pragma weak mjv_connector
#endif

#endif  // MUJOCO_SYS_OPTIONAL_H_
