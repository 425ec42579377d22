"""Housings that another program has reduced to mass, stiffness and damping matrices with interface nodes.

- :func:`read_matrix` reads a matrix from a file of Nastran, Abaqus, CalculiX, Ansys, Matrix Market, NumPy or NetCDF as
  a :class:`LabelledMatrix`, and :func:`read_row_labels` the nodes of its rows from a file of their own;
  :func:`reduced_matrices` makes :class:`ReducedMatrices` in SI of them, which :func:`write_matrices` writes.
- :class:`ReducedHousing` stands on :class:`NodeSpring` entries and has named seats and sensors at its nodes
  (:class:`NodeSeat`, :class:`NodeSensor`); its :class:`ReducedCertificate` holds what can be proved of it.
- :meth:`ReducedHousing.modes` solves its natural modes.
"""

from gearwhine.housing.reduced.certificate import ReducedCertificate as ReducedCertificate
from gearwhine.housing.reduced.matrices import LabelledMatrix as LabelledMatrix
from gearwhine.housing.reduced.matrices import ReducedMatrices as ReducedMatrices
from gearwhine.housing.reduced.matrices import RowLabels as RowLabels
from gearwhine.housing.reduced.matrices import StaticStiffness as StaticStiffness
from gearwhine.housing.reduced.matrices import reduced_matrices as reduced_matrices
from gearwhine.housing.reduced.matrices import static_stiffness as static_stiffness
from gearwhine.housing.reduced.matrix_files import read_matrix as read_matrix
from gearwhine.housing.reduced.reduced_housing import NodeSeat as NodeSeat
from gearwhine.housing.reduced.reduced_housing import NodeSensor as NodeSensor
from gearwhine.housing.reduced.reduced_housing import NodeSpring as NodeSpring
from gearwhine.housing.reduced.reduced_housing import ReducedHousing as ReducedHousing
from gearwhine.housing.reduced.reduced_housing import ReducedModes as ReducedModes
from gearwhine.housing.reduced.row_labels import read_row_labels as read_row_labels
from gearwhine.housing.reduced.writing import write_matrices as write_matrices
