/* The header alone, twice, its macros used: C89 and C++98, every warning denied. */
#include "hpf.h"
#include "hpf.h"

int main(void) {
  static uint64_t memory[HPF_F64_BYTES(2, 80) / sizeof(uint64_t) + 1];
  hpf_f64_policy_t policy;
  hpf_f32_settings_t settings;
  HPF_PREPARE(policy);
  HPF_PREPARE(settings);
  return policy.struct_size != sizeof policy || settings.abi_version != HPF_ABI_VERSION || memory[0] != 0;
}
