"""Module for 3D Slicer: plans facial fat grafting on a model or a CT, and shows the skin move.

The daemon lipofilld computes; this module sends it a face and landmarks, and receives the skin.
What needs no Slicer is in LipofillLib. Research and planning aid, not a medical device.
"""

import os
import tempfile

import ctk
import qt
import slicer
import vtk
from slicer.ScriptedLoadableModule import (
    ScriptedLoadableModule,
    ScriptedLoadableModuleLogic,
    ScriptedLoadableModuleTest,
    ScriptedLoadableModuleWidget,
)

NOTICE = "Research and planning aid, not a medical device."
COLOURS = "vtkMRMLColorTableNodeFileViridis.txt"
POLL_MS = 100


class Lipofill(ScriptedLoadableModule):
    """What Slicer lists."""

    def __init__(self, parent):
        ScriptedLoadableModule.__init__(self, parent)
        parent.title = "Lipofill: facial fat grafting"
        parent.categories = ["Simulation"]
        parent.dependencies = []
        parent.contributors = ["The Lipofill project"]
        parent.helpText = (
            "Predicts how fat that is injected between the layers of a face spreads and lifts the skin. "
            "Pick a surface or a CT and landmarks, say where how much fat goes, and run. " + NOTICE
        )
        parent.acknowledgementText = "The method is that of Majorczyk, Cotin, Duriez and Allard."


class LipofillLogic(ScriptedLoadableModuleLogic):
    """Between the scene, which is in RAS, and LipofillLib.

    Attributes
    ----------
    resultNode : vtkMRMLModelNode or None
        The skin of the last run.
    motion : LipofillLib.motion.Motion or None
    """

    def __init__(self):
        ScriptedLoadableModuleLogic.__init__(self)
        self.resultNode = None
        self.motion = None

    def surfaceOf(self, node, isovalue):
        """The surface of a model, or the skin of a volume, in the world's RAS.

        Raises ValueError for a node without a surface.
        """
        from LipofillLib import surfaces

        if node.IsA("vtkMRMLVolumeNode"):
            if node.GetImageData() is None:
                raise ValueError(f"the volume {node.GetName()} has no voxels")
            toRas = vtk.vtkMatrix4x4()
            node.GetIJKToRASMatrix(toRas)
            surface = surfaces.skin_of_volume(node.GetImageData(), toRas, isovalue)
        else:
            surface = node.GetPolyData()
            if surface is None or surface.GetNumberOfCells() == 0:
                raise ValueError(f"the model {node.GetName()} has no surface")
        if node.GetParentTransformNode() is None:
            return surface
        toWorld = vtk.vtkGeneralTransform()
        slicer.vtkMRMLTransformNode.GetTransformBetweenNodes(node.GetParentTransformNode(), None, toWorld)
        return surfaces.moved_by(surface, toWorld)

    def landmarksOf(self, node):
        """Labels and places of the control points that are placed, in LPS."""
        from LipofillLib import surfaces

        labelled = []
        for k in range(node.GetNumberOfControlPoints()):
            if node.GetNthControlPointPositionStatus(k) != slicer.vtkMRMLMarkupsNode.PositionDefined:
                continue
            world = [0.0, 0.0, 0.0]
            node.GetNthControlPointPositionWorld(k, world)
            labelled.append((node.GetNthControlPointLabel(k), tuple(surfaces.turn(world).tolist())))
        return labelled

    def prepare(self, faceNode, isovalue, landmarksNode, choices, server, folder):
        """A run that is ready to start, its scan written into `folder`.

        Returns
        -------
        (Runner, list of str)
            The labels in the list are no landmarks that the daemon knows.
        """
        from LipofillLib import plans, runner, surfaces

        named, unknown = plans.name_landmarks(self.landmarksOf(landmarksNode))
        scan = os.path.join(folder, "face.ply")
        surfaces.write_scan(self.surfaceOf(faceNode, isovalue), scan)
        return runner.Runner(plans.make_plan(scan, named, choices), server or None), unknown

    def beginMotion(self, motion):
        """Shows a skin at rest, in place of that of an earlier run."""
        from LipofillLib import surfaces

        self.motion = motion
        surface = surfaces.make_surface(motion.points_mm, motion.cells)
        if self.resultNode is None or slicer.mrmlScene.GetNodeByID(self.resultNode.GetID()) is None:
            self.resultNode = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLModelNode", "Lipofill skin")
        self.resultNode.SetAndObservePolyData(surface)
        self.resultNode.CreateDefaultDisplayNodes()

    def showStill(self, index, scalar):
        """Moves the skin to a still, with its scalars on it; `scalar` is what colours it."""
        from LipofillLib import motion as names
        from LipofillLib import surfaces

        still = self.motion.stills[index]
        surface = self.resultNode.GetPolyData()
        surfaces.place(surface, self.motion.points_at(index))
        surfaces.set_scalars(
            surface,
            [
                (names.LIFT, still.lift_mm),
                (names.PRESSURE, still.pressure_pa),
                (names.DISPLACEMENT, surfaces.turn(still.displacement_mm)),
            ],
        )
        self.colourBy(scalar)

    def colourBy(self, scalar):
        """Colours the skin by a scalar, over its range in all stills, with a legend in its unit."""
        from LipofillLib import motion as names

        display = self.resultNode.GetDisplayNode()
        display.SetActiveScalarName(scalar)
        display.SetAndObserveColorNodeID(COLOURS)
        display.SetScalarRangeFlag(slicer.vtkMRMLDisplayNode.UseManualScalarRange)
        display.SetScalarRange(0.0, max(self.motion.most(scalar), 1e-6))
        display.SetScalarVisibility(True)
        legend = slicer.modules.colors.logic().AddDefaultColorLegendDisplayNode(self.resultNode)
        legend.SetTitleText(names.TITLES[scalar])


class LipofillWidget(ScriptedLoadableModuleWidget):
    """The panel. It polls the run with a timer, since Slicer's scene belongs to its main thread."""

    def __init__(self, parent=None):
        ScriptedLoadableModuleWidget.__init__(self, parent)
        self.logic = None
        self.runner = None
        self.folder = None
        self.zones = []

    def setup(self):
        ScriptedLoadableModuleWidget.setup(self)
        try:
            import lipofill
        except ImportError as error:
            self.addInstallation(str(error))
            return
        self.logic = LipofillLogic()
        self.timer = qt.QTimer()
        self.timer.setInterval(POLL_MS)
        self.timer.connect("timeout()", self.onTimer)
        self.addFace()
        self.addPlan()
        self.addRun(os.environ.get("LIPOFILL_SERVER", ""), lipofill.__version__)
        self.addResult()
        self.layout.addStretch(1)
        self.updateButtons()

    def cleanup(self):
        """Slicer unloads the panel: a run that goes on is cancelled."""
        if self.runner is not None:
            self.runner.cancel()
            self.runner.join(5.0)
        self.dropFolder()

    def addSection(self, title):
        button = ctk.ctkCollapsibleButton()
        button.text = title
        self.layout.addWidget(button)
        return qt.QFormLayout(button)

    def addInstallation(self, reason):
        """The panel where Slicer's Python has no client: it says how it comes there."""
        form = self.addSection("The Lipofill client is not installed")
        form.addRow(qt.QLabel(f"Slicer's Python says: {reason}. Name the folder of the package and install it."))
        self.packagePath = ctk.ctkPathLineEdit()
        self.packagePath.filters = ctk.ctkPathLineEdit.Dirs
        form.addRow("Folder:", self.packagePath)
        button = qt.QPushButton("Install, then reload the module")
        button.connect("clicked(bool)", self.onInstall)
        form.addRow(button)
        self.layout.addStretch(1)

    def onInstall(self, _=False):
        slicer.util.pip_install(f'"{self.packagePath.currentPath}"')

    def addSelector(self, form, label, types, tip):
        selector = slicer.qMRMLNodeComboBox()
        selector.nodeTypes = types
        selector.addEnabled = False
        selector.removeEnabled = False
        selector.noneEnabled = True
        selector.setMRMLScene(slicer.mrmlScene)
        selector.toolTip = tip
        selector.connect("currentNodeChanged(vtkMRMLNode*)", self.updateButtons)
        form.addRow(label, selector)
        return selector

    def addFace(self):
        form = self.addSection("Face")
        self.faceSelector = self.addSelector(
            form,
            "Skin:",
            ["vtkMRMLModelNode", "vtkMRMLScalarVolumeNode"],
            "A surface of the face, or a CT in which the skin is found",
        )
        self.isovalue = qt.QDoubleSpinBox()
        self.isovalue.setRange(-100000.0, 100000.0)
        self.isovalue.setValue(-300.0)
        self.isovalue.toolTip = "Where the skin is in a volume: -300 HU in a CT"
        form.addRow("Value of the skin:", self.isovalue)
        self.landmarkSelector = self.addSelector(
            form, "Landmarks:", ["vtkMRMLMarkupsFiducialNode"], "Points labelled go_l, zygion_left, exR, prn, ..."
        )
        self.landmarkNote = qt.QLabel("left and right are the subject's own")
        form.addRow(self.landmarkNote)

    def addPlan(self):
        from LipofillLib import plans

        form = self.addSection("Fat")
        self.region, self.side, self.plane = qt.QComboBox(), qt.QComboBox(), qt.QComboBox()
        self.region.addItems(list(plans.REGIONS))
        self.side.addItems(["left", "right"])
        self.plane.addItems(list(plans.PLANES))
        self.volume = qt.QDoubleSpinBox()
        self.volume.setRange(0.05, 50.0)
        self.volume.setValue(1.0)
        self.volume.suffix = " mL"
        form.addRow("Region:", self.region)
        form.addRow("Side (the subject's own):", self.side)
        form.addRow("Volume:", self.volume)
        add = qt.QPushButton("Add the zone, or change its volume")
        add.connect("clicked(bool)", self.onAddZone)
        clear = qt.QPushButton("Take all zones away")
        clear.connect("clicked(bool)", self.onClearZones)
        form.addRow(add)
        form.addRow(clear)
        self.zoneLabel = qt.QLabel("no zone yet")
        form.addRow("Zones:", self.zoneLabel)
        form.addRow("Plane:", self.plane)

    def addRun(self, server, version):
        from LipofillLib import plans

        form = self.addSection("Run")
        self.server = qt.QLineEdit(server)
        self.server.placeholderText = "127.0.0.1:50061"
        form.addRow("Daemon:", self.server)
        self.resolution = qt.QComboBox()
        self.resolution.addItems(list(plans.RESOLUTIONS))
        form.addRow("Resolution:", self.resolution)
        self.settledOnly = qt.QCheckBox("The settled shape alone, which is faster")
        form.addRow(self.settledOnly)
        self.runButton = qt.QPushButton("Run")
        self.runButton.connect("clicked(bool)", self.onRun)
        form.addRow(self.runButton)
        self.progress = qt.QProgressBar()
        self.progress.setRange(0, 100)
        form.addRow(self.progress)
        self.status = qt.QLabel(f"Lipofill {version}. {NOTICE}")
        self.status.wordWrap = True
        form.addRow(self.status)

    def addResult(self):
        from LipofillLib import motion

        form = self.addSection("Result")
        self.scalars = list(motion.TITLES)
        self.scalar = qt.QComboBox()
        self.scalar.addItems(list(motion.TITLES.values()))
        self.scalar.connect("currentIndexChanged(int)", self.onShow)
        form.addRow("Colour:", self.scalar)
        self.time = ctk.ctkSliderWidget()
        self.time.decimals = 0
        self.time.connect("valueChanged(double)", self.onShow)
        form.addRow("Still:", self.time)
        self.figures = qt.QTableWidget()
        self.figures.setColumnCount(3)
        self.figures.setHorizontalHeaderLabels(["figure", "value", "unit"])
        form.addRow(self.figures)
        form.addRow(qt.QLabel(NOTICE))

    def updateButtons(self, _=None):
        if self.runner is not None:
            self.runButton.text, self.runButton.enabled = "Cancel", True
            return
        chosen = self.faceSelector.currentNode() is not None and self.landmarkSelector.currentNode() is not None
        self.runButton.text, self.runButton.enabled = "Run", chosen and bool(self.zones)

    def onAddZone(self, _=False):
        from LipofillLib import plans

        name = f"{self.region.currentText}_{self.side.currentText}"
        self.zones = [zone for zone in self.zones if zone.region != name] + [plans.Zone(name, self.volume.value)]
        self.showZones()

    def onClearZones(self, _=False):
        self.zones = []
        self.showZones()

    def showZones(self):
        words = [f"{zone.region}: {zone.volume_ml:g} mL" for zone in self.zones]
        self.zoneLabel.text = "\n".join(words) or "no zone yet"
        self.updateButtons()

    def onRun(self, _=False):
        from LipofillLib import plans

        if self.runner is not None:
            self.runner.cancel()
            self.status.text = "It is being cancelled."
            return
        choices = plans.Choices(
            list(self.zones), self.plane.currentText, self.resolution.currentText, self.settledOnly.checked
        )
        self.folder = tempfile.TemporaryDirectory(prefix="lipofill-slicer-")
        try:
            self.runner, unknown = self.logic.prepare(
                self.faceSelector.currentNode(),
                self.isovalue.value,
                self.landmarkSelector.currentNode(),
                choices,
                self.server.text.strip(),
                self.folder.name,
            )
        except ValueError as error:
            from LipofillLib import runner

            self.finish(runner.explain(error))
            return
        self.landmarkNote.text = f"Not known, and left out: {', '.join(unknown)}" if unknown else "all are known"
        self.status.text = "It begins."
        self.runner.start()
        self.timer.start()
        self.updateButtons()

    def onTimer(self):
        for news in self.runner.take():
            getattr(self, f"take{type(news).__name__}")(news)
            if self.runner is None:
                break

    def takeProgressed(self, news):
        self.progress.setValue(int(100 * news.fraction))
        self.status.text = f"{news.stage}: {news.text}"

    def takeBegan(self, news):
        self.logic.beginMotion(news.motion)

    def takeMoved(self, news):
        self.logic.motion.add(news.still)
        self.time.blockSignals(True)
        self.time.maximum = len(self.logic.motion) - 1
        self.time.value = len(self.logic.motion) - 1
        self.time.blockSignals(False)
        self.onShow()

    def takeEnded(self, news):
        from LipofillLib import figures

        rows = figures.rows_of(news.simulation)
        self.figures.setRowCount(len(rows))
        for k, row in enumerate(rows):
            for column, text in enumerate(row):
                self.figures.setItem(k, column, qt.QTableWidgetItem(text))
        self.progress.setValue(100)
        self.finish(f"{rows[0][1].lower()}. {NOTICE}")

    def takeFailed(self, news):
        self.finish(news.message)

    def takeCancelled(self, _):
        self.finish("It was cancelled; what it had made on the daemon is gone.")

    def finish(self, words):
        self.timer.stop()
        self.runner = None
        self.dropFolder()
        self.status.text = words
        self.updateButtons()

    def dropFolder(self):
        if self.folder is not None:
            self.folder.cleanup()
            self.folder = None

    def onShow(self, _=None):
        if self.logic.motion is None or len(self.logic.motion) == 0:
            return
        index = min(int(self.time.value), len(self.logic.motion) - 1)
        self.logic.showStill(index, self.scalars[self.scalar.currentIndex])


class LipofillTest(ScriptedLoadableModuleTest):
    """The self-test that Slicer offers: a ball of tissue in a volume becomes its skin."""

    def runTest(self):
        self.setUp()
        image = vtk.vtkImageData()
        image.SetDimensions(20, 20, 20)
        image.AllocateScalars(vtk.VTK_SHORT, 1)
        for k in range(20):
            for j in range(20):
                for i in range(20):
                    inside = (i - 10) ** 2 + (j - 10) ** 2 + (k - 10) ** 2 < 36
                    image.SetScalarComponentFromDouble(i, j, k, 0, 0.0 if inside else -1000.0)
        volume = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "ball")
        volume.SetAndObserveImageData(image)
        surface = LipofillLogic().surfaceOf(volume, -500.0)
        bounds = surface.GetBounds()
        self.assertAlmostEqual(bounds[1] - bounds[0], 11.0, delta=0.5)
        self.delayDisplay("The skin of a ball was found")
