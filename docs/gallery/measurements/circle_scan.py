r"""
A laser spot that moves around a casing
=======================================

A spot that rotates at a rate W measures :math:`\cos n\theta \cos\omega t` as two lines at :math:`\omega \pm nW`. Equal
lines mean a standing wave; their difference is the travelling part. A casing driven at the frequency of one member of a
pair moves a little in the other one too, a quarter of a period late: some of the wave travels. The record is SYNTHETIC.
"""

import casingfem as cf
from casingfem import rig
from casingfem.plot.body.shapes import figure_shapes
from casingfem.plot.experiment import figure_scan

casing = cf.Shell(
    chart=cf.Cylinder(radius=0.10, height=0.25),
    thickness=1.5e-3,
    material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    supports={"base": cf.Clamped()},
    radius_defect=cf.FourierField.of({6: 1e-3}),
    mesh=cf.ShellMesh(order=6, rows=1, around=9),
)
modes = cf.modes(casing, count=8)
figure = figure_shapes(modes, [0, 1])

# %%
# The pair of three nodal diameters; the force drives its first member.

bench = rig.rig_of(modes, [rig.Place(at=(0.25, 0.3)), *rig.circle(0.25, 24)], zeta=0.002)
tone = rig.Tone(bench.freq[0])
turning = rig.Turning(mirror=4.1)  # turns a second
test = rig.scan(bench, turning, [tone], circle=range(1, 25), drive=0, fs=4096.0, seconds=2.0, seed=20261, snr_db=20.0)
found = cf.circle.demodulate(test.record, 8)
wave = found.wave(0, 3)
print(wave)
figure = figure_scan(test.record, found)

assert 0.05 < wave.travelling < 0.1
assert abs(wave.angle_deg - 30.0) < 0.5
