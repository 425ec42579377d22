"""Sound of a machine: its lines and its housing's modes, at microphones, of mesh harmonics, and the proofs of all.

- :mod:`~gearwhine.coupling.sound.acoustics`: settings, method and medium, floor and microphones.
- :mod:`~gearwhine.coupling.sound.acoustics_checks`: what is wrong with them on a housing's mesh.
- :mod:`~gearwhine.coupling.sound.motion_lines`: lines of a motion that drive the housing.
- :mod:`~gearwhine.coupling.sound.proofs`: proofs of a sound.
- :mod:`~gearwhine.coupling.sound.microphones`: sound pressure over time at microphones.
- :mod:`~gearwhine.coupling.sound.solution`: sound of modes and lines.
- :mod:`~gearwhine.coupling.sound.mesh_harmonics`: loudest mesh harmonics, with the gradient of their power.
"""

from gearwhine.coupling.sound.acoustics import Acoustics as Acoustics
from gearwhine.coupling.sound.acoustics import Microphone as Microphone
