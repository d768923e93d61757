"""Stands in for Slicer's API, as far as the module uses it; VTK is the real one.

A name that is not written down here raises AttributeError, so that the module can only use what is
known to be there. Scenes hold nodes, widgets hold values and emit what tests tell them to.
"""

import sys
import types
import unittest

import vtk


class Node:
    """A node of the scene."""

    kinds = ()

    def __init__(self, name=""):
        self.name, self.id, self.parent = name, "", None

    def GetName(self):
        return self.name

    def GetID(self):
        return self.id

    def IsA(self, kind):
        return kind in self.kinds

    def GetParentTransformNode(self):
        return self.parent


class DisplayNode:
    def __init__(self):
        self.scalar, self.visible, self.range, self.flag, self.colours = "", False, None, None, ""

    def SetActiveScalarName(self, name):
        self.scalar = name

    def SetScalarVisibility(self, visible):
        self.visible = visible

    def SetScalarRangeFlag(self, flag):
        self.flag = flag

    def SetScalarRange(self, least, most):
        self.range = (least, most)

    def SetAndObserveColorNodeID(self, name):
        self.colours = name


class ModelNode(Node):
    kinds = ("vtkMRMLModelNode",)

    def __init__(self, name=""):
        super().__init__(name)
        self.surface, self.display = None, None

    def GetPolyData(self):
        return self.surface

    def SetAndObservePolyData(self, surface):
        self.surface = surface

    def CreateDefaultDisplayNodes(self):
        self.display = self.display or DisplayNode()

    def GetDisplayNode(self):
        return self.display


class VolumeNode(Node):
    kinds = ("vtkMRMLScalarVolumeNode", "vtkMRMLVolumeNode")

    def __init__(self, name=""):
        super().__init__(name)
        self.image, self.to_ras = None, vtk.vtkMatrix4x4()

    def GetImageData(self):
        return self.image

    def SetAndObserveImageData(self, image):
        self.image = image

    def GetIJKToRASMatrix(self, matrix):
        matrix.DeepCopy(self.to_ras)


class MarkupsNode(Node):
    kinds = ("vtkMRMLMarkupsFiducialNode", "vtkMRMLMarkupsNode")
    PositionUndefined, PositionPreview, PositionDefined, PositionMissing = range(4)

    def __init__(self, name="", points=()):
        super().__init__(name)
        self.points = [(*point, self.PositionDefined) if len(point) == 2 else point for point in points]

    def GetNumberOfControlPoints(self):
        return len(self.points)

    def GetNthControlPointLabel(self, k):
        return self.points[k][0]

    def GetNthControlPointPositionWorld(self, k, world):
        world[:] = self.points[k][1]

    def GetNthControlPointPositionStatus(self, k):
        return self.points[k][2]


class TransformNode(Node):
    def __init__(self, transform):
        super().__init__("transform")
        self.transform = transform

    @staticmethod
    def GetTransformBetweenNodes(source, target, transform):
        assert target is None, "only to the world"
        transform.Concatenate(source.transform)


class Scene:
    classes = {"vtkMRMLModelNode": ModelNode, "vtkMRMLScalarVolumeNode": VolumeNode}

    def __init__(self):
        self.nodes = {}

    def AddNewNodeByClass(self, kind, name=""):
        node = self.classes[kind](name)
        node.id = f"{kind}{len(self.nodes) + 1}"
        self.nodes[node.id] = node
        return node

    def GetNodeByID(self, name):
        return self.nodes.get(name)

    def RemoveNode(self, node):
        del self.nodes[node.id]


class Widget:
    """What all widgets share. `emit` does what the signal would."""

    signals = ()

    def __init__(self, text=""):
        self.text, self.enabled, self.toolTip, self.wordWrap, self.blocked = text, True, "", False, False
        self.slots = {}

    def connect(self, signal, slot):
        assert signal in self.signals, f"{type(self).__name__} has no signal {signal}"
        self.slots.setdefault(signal, []).append(slot)

    def emit(self, signal, *values):
        if not self.blocked:
            for slot in self.slots.get(signal, []):
                slot(*values)

    def blockSignals(self, blocked):
        self.blocked = blocked


class PushButton(Widget):
    signals = ("clicked(bool)",)

    def click(self):
        assert self.enabled, f"{self.text} cannot be pressed"
        self.emit("clicked(bool)", False)


class CheckBox(Widget):
    checked = False


class LineEdit(Widget):
    placeholderText = ""


class SpinBox(Widget):
    value, suffix = 0.0, ""

    def setRange(self, least, most):
        self.least, self.most = least, most

    def setValue(self, value):
        self.value = value


class ProgressBar(SpinBox):
    pass


class ComboBox(Widget):
    signals = ("currentIndexChanged(int)",)

    def __init__(self):
        super().__init__()
        self.items, self.index = [], 0

    def addItems(self, items):
        self.items += items

    @property
    def currentText(self):
        return self.items[self.index]

    @property
    def currentIndex(self):
        return self.index

    def choose(self, item):
        self.index = self.items.index(item)
        self.emit("currentIndexChanged(int)", self.index)


class SliderWidget(Widget):
    signals = ("valueChanged(double)",)
    maximum, decimals = 99.0, 2

    def __init__(self):
        super().__init__()
        self.position = 0.0

    @property
    def value(self):
        return self.position

    @value.setter
    def value(self, value):
        if value != self.position:
            self.position = value
            self.emit("valueChanged(double)", value)


class TableWidget(Widget):
    def __init__(self):
        super().__init__()
        self.cells = {}

    def setColumnCount(self, count):
        self.columns = count

    def setRowCount(self, count):
        self.cells = {}

    def setHorizontalHeaderLabels(self, labels):
        self.labels = labels

    def setItem(self, row, column, item):
        self.cells[row, column] = item.text


class NodeComboBox(Widget):
    signals = ("currentNodeChanged(vtkMRMLNode*)",)
    nodeTypes, addEnabled, removeEnabled, noneEnabled = (), True, True, False

    def __init__(self):
        super().__init__()
        self.node = None

    def setMRMLScene(self, scene):
        self.scene = scene

    def currentNode(self):
        return self.node

    def choose(self, node):
        assert any(node.IsA(kind) for kind in self.nodeTypes), f"{node.name} is none of {self.nodeTypes}"
        self.node = node
        self.emit("currentNodeChanged(vtkMRMLNode*)", node)


class PathLineEdit(Widget):
    Dirs, filters, currentPath = 1, 0, ""


class FormLayout:
    def __init__(self, parent):
        self.parent = parent

    def addRow(self, *parts):
        assert 1 <= len(parts) <= 2


class Layout:
    def __init__(self):
        self.widgets = []

    def addWidget(self, widget):
        self.widgets.append(widget)

    def addStretch(self, _):
        pass


class Timer(Widget):
    signals = ("timeout()",)
    running = False

    def setInterval(self, interval_ms):
        self.interval_ms = interval_ms

    def start(self):
        self.running = True

    def stop(self):
        self.running = False


class ModuleWidget:
    def __init__(self, parent=None):
        self.parent, self.layout = parent, Layout()

    def setup(self):
        pass


class ModuleTest(unittest.TestCase):
    def __init__(self):
        super().__init__("runTest")

    def delayDisplay(self, _):
        pass


class ColorLogic:
    titles = {}

    class Legend:
        def __init__(self, node):
            self.node = node

        def SetTitleText(self, text):
            ColorLogic.titles[self.node.id] = text

    def AddDefaultColorLegendDisplayNode(self, node):
        return self.Legend(node)


def module(name, **members):
    made = types.ModuleType(name)
    made.__dict__.update(members)
    sys.modules[name] = made
    return made


def install():
    """Puts the modules slicer, qt and ctk where imports find them."""
    base = types.SimpleNamespace
    loadable = module(
        "slicer.ScriptedLoadableModule",
        ScriptedLoadableModule=type("Module", (), {"__init__": lambda self, parent: None}),
        ScriptedLoadableModuleLogic=type("Logic", (), {}),
        ScriptedLoadableModuleTest=ModuleTest,
        ScriptedLoadableModuleWidget=ModuleWidget,
    )
    installed = []
    slicer = module(
        "slicer",
        ScriptedLoadableModule=loadable,
        mrmlScene=Scene(),
        qMRMLNodeComboBox=NodeComboBox,
        vtkMRMLMarkupsNode=MarkupsNode,
        vtkMRMLTransformNode=TransformNode,
        vtkMRMLDisplayNode=base(UseManualScalarRange=0),
        modules=base(colors=base(logic=ColorLogic)),
        util=base(pip_install=installed.append),
        installed=installed,
    )
    module(
        "qt",
        QCheckBox=CheckBox,
        QComboBox=ComboBox,
        QDoubleSpinBox=SpinBox,
        QFormLayout=FormLayout,
        QLabel=Widget,
        QLineEdit=LineEdit,
        QProgressBar=ProgressBar,
        QPushButton=PushButton,
        QTableWidget=TableWidget,
        QTableWidgetItem=Widget,
        QTimer=Timer,
    )
    module("ctk", ctkCollapsibleButton=Widget, ctkPathLineEdit=PathLineEdit, ctkSliderWidget=SliderWidget)
    return slicer
