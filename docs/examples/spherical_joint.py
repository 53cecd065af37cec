"""The paper's spherical joint as printed (eq. 14) beside its sound form, mode by mode."""

import prs_model as prs

machine = prs.load_machine("head_3prs")
sound = machine.modes(8)
printed = machine.replace({"joints.S.as_printed": True}).modes(8)

print("mode   sound / Hz  as printed / Hz   change")
for k, (a, b) in enumerate(zip(sound.frequencies, printed.frequencies, strict=True), 1):
    print(f"{k:>4} {a:12.3f} {b:16.3f} {b / a - 1:+8.1%}")
