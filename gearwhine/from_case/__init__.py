"""Library objects built from a case: each module turns tables of the case into objects of the physics packages.

Tables come from :mod:`gearwhine.case`; what is built here is solved by :mod:`gearwhine.solve`. Errors of the library
are raised as problems of the keys that cause them.

- :mod:`~gearwhine.from_case.mesh`, :mod:`~gearwhine.from_case.mesh_health`: the housing's mesh and its checks.
- :mod:`~gearwhine.from_case.fixtures`: supports, mounts, joints, masses and sensors on that mesh.
- :mod:`~gearwhine.from_case.parametric_housing`: the housing at any values of the fitted parameters.
- :mod:`~gearwhine.from_case.machine`: the machine in its housing; its parts are made by :mod:`gearwhine.case.parts`.
"""
