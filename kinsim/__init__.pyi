from .clock import Courant as Courant
from .clock import Fixed as Fixed
from .dump import Dump as Dump
from .errors import InputError as InputError
from .kinetic.velocity import Uniform as Uniform
from .measure.compare import compare as compare
from .method import Kinetic as Kinetic
from .method import Macroscopic as Macroscopic
from .model.cells import Cells as Cells
from .model.chute import ConstantSlope as ConstantSlope
from .model.friction import Coulomb as Coulomb
from .model.friction import Frictionless as Frictionless
from .model.heap import Blocks as Blocks
from .model.heap import Expression as Expression
from .model.heap import Parabola as Parabola
from .model.heap import Profile as Profile
from .model.heap import Sine as Sine
from .model.heap import Table as Table
from .read import load_scene as load_scene
from .run import Run as Run
from .run import Verdict as Verdict
from .scene import Scene as Scene
from .simulate import simulate as simulate
from .step import Step as Step
from .step import step as step

__version__: str
