"""ParaView plugin of Plenoflame: scenes, flames, light fields and rays as sources and readers; views, refocusing and
development as filters. Tools > Manage Plugins > Load New; docs/user/paraview.md.

It computes with the Python package that needs no VTK (the folder `python` beside this file), so that the one VTK in the
process is ParaView's. Names, units and tooltips of properties are those of the scene's keys.
"""

import pathlib
import re
import sys

import paraview

WANTED = "5.11"
if not str(getattr(paraview, "__version__", "")).startswith(WANTED + "."):
    raise ImportError(f"Plenoflame's plugin is made for ParaView {WANTED}; this is ParaView "
                      f"{getattr(paraview, '__version__', 'of an unknown version')}")
HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "python"), str(HERE)]

import plenoflame
from paraview.util.vtkAlgorithm import VTKPythonAlgorithmBase, smdomain, smhint, smproperty, smproxy
from plenoflame import _core
from plenoflame._vtk import picture_to_image
from plenoflame_data import camera_to_blocks, owned
from vtkmodules.vtkCommonCore import vtkOutputWindow
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData, vtkMultiBlockDataSet, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

SCHEMA = {path: (about, unit, allowed) for path, about, unit, allowed in _core.schema()}


def words(path):
    """Label and tooltip of a scene's key: its last word; its unit and description. Names in scripts are made of labels, which
    therefore have no units."""
    about, unit, allowed = SCHEMA[path]
    label = path.split(".")[-1].replace("_", " ").title()
    return label, (f"[{unit}] " if unit else "") + f"{about} Key of the scene: {path}." + (f" Allowed: {allowed}." if allowed else "")


def _escaped(text):
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")


def _settable(name, default, read=lambda *values: values[0] if len(values) == 1 else values):
    """Gives a class the attribute _name of a property Name, and its setter, which has one argument for each element."""
    attribute = re.sub("(?=[A-Z])", "_", name).lower()

    def decorate(kind):
        undecorated = getattr(kind, "_pv_original_func", kind)  # ParaView's decorators put a function in place of a class
        setattr(undecorated, attribute, read(*default))
        setattr(undecorated, "Set" + name, lambda self, *values: self.set(attribute, read(*values)))
        return kind
    return decorate


def _property(kind, name, label, about, default, domain="", **read):
    """A property of as many elements as there are default values."""
    settable = _settable(name, default, **read)
    described = smproperty.xml(f"""
      <{kind} name="{name}" label="{_escaped(label)}" command="Set{name}" number_of_elements="{len(default)}"
          default_values="{_escaped(" ".join(map(str, default)))}">{domain}<Documentation>{_escaped(about)}</Documentation></{kind}>""")
    return lambda decorated: described(settable(decorated))


def text(name, label, about):
    return _property("StringVectorProperty", name, label, about, [""], read=lambda value: value or "")


def number(name, label, about, *default):
    return _property("DoubleVectorProperty", name, label, about, default)


def whole(name, label, about, *default, low):
    return _property("IntVectorProperty", name, label, about, default, f'<IntRangeDomain name="range" min="{low}"/>')


def flag(name, label, about, default=0):
    return _property("IntVectorProperty", name, label, about, [default], '<BooleanDomain name="bool"/>', read=bool)


def choice(name, label, about, entries, default=0):
    """The attribute that it makes is the text of the chosen entry."""
    listed = "".join(f'<Entry value="{i}" text="{_escaped(entry)}"/>' for i, entry in enumerate(entries))
    return _property("IntVectorProperty", name, label, about, [default],
                     f'<EnumerationDomain name="enum">{listed}</EnumerationDomain>', read=entries.__getitem__)


def listed(name, label, about):
    """A text that is chosen from the list that Get<name>Names gives."""
    settable = _settable(name, [""], lambda value: value or "")
    described = smproperty.xml(f"""
      <StringVectorProperty name="{name}Names" command="Get{name}Names" number_of_elements="0" information_only="1"/>
      <StringVectorProperty name="{name}" label="{label}" command="Set{name}" number_of_elements="1" default_values="">
        <StringListDomain name="names"><RequiredProperties><Property name="{name}Names" function="{name}Names"/></RequiredProperties>
        </StringListDomain><Documentation>{_escaped(about)}</Documentation></StringVectorProperty>""")
    return lambda decorated: described(settable(decorated))


CHANNEL = listed("Channel", "Channel", "Name of the channel; empty: the first")
TIMES = smproperty.xml("""
  <DoubleVectorProperty name="TimestepValues" command="GetTimestepValues" information_only="1" si_class="vtkSITimeStepsProperty"/>""")


# --- sources and readers ---

class _Algorithm(VTKPythonAlgorithmBase):
    """One that reports what Plenoflame refuses in one line, and computes once for the same properties and moment.

    compute() gives the result, fill(result, outputs) writes it, and sizes(result) tells the points of images by port, which
    ParaView wants to know beforehand. steps() are the moments [s] for which there are results, none without changes."""

    def __init__(self, **ports):
        super().__init__(**ports)
        self._kept = None  # ((time, moment), result)
        self._moment = None

    def steps(self):
        return []

    def GetTimestepValues(self):
        try:
            return self.steps()
        except (plenoflame.Error, _core.Failure, OSError):
            return []  # RequestData says it

    def progress(self, fraction):
        self.UpdateProgress(fraction)
        return self.GetAbortExecute()

    def time(self):
        """Changes with what the result is made of."""
        return self.GetMTime()

    def result(self):
        made_of = self.time(), self._moment
        if self._kept is None or self._kept[0] != made_of:
            self._kept = (made_of, self.compute())
        return self._kept[1]

    def sizes(self, _result):
        return {}

    def RequestInformation(self, request, inputs, outputs):
        try:
            sizes = self.sizes(self.result())
        except (plenoflame.Error, _core.Failure, OSError):
            return 1  # RequestData says it
        steps = self.GetTimestepValues()
        for port in range(self.GetNumberOfOutputPorts()):
            if steps:
                outputs.GetInformationObject(port).Set(vtkStreamingDemandDrivenPipeline.TIME_STEPS(), steps, len(steps))
                outputs.GetInformationObject(port).Set(vtkStreamingDemandDrivenPipeline.TIME_RANGE(), (steps[0], steps[-1]), 2)
        for port, size in sizes.items():
            extent = [bound for count in size for bound in (0, count - 1)]
            outputs.GetInformationObject(port).Set(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT(), extent, 6)
        return 1

    def RequestData(self, request, inputs, outputs):
        step = vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP()
        asked = [port.Get(step) for port in map(outputs.GetInformationObject, range(self.GetNumberOfOutputPorts())) if port.Has(step)]
        earlier = [moment for moment in self.GetTimestepValues() if asked and moment <= asked[0]]
        self._moment = earlier[-1] if earlier else None  # a result lasts until the next one
        return self.reported(lambda: self.fill(self.result(), outputs))

    def reported(self, action):
        try:
            action()
        except (plenoflame.Error, _core.Failure) as error:
            # One line: a failed request would have ParaView print the state of its pipeline after it.
            vtkOutputWindow.GetInstance().DisplayErrorText(f"Plenoflame: {error}\n")
        return 1

    def set(self, name, value):
        if getattr(self, name) != value:
            setattr(self, name, value)
            self.Modified()


class _OfScene(_Algorithm):
    """One that starts from a scene file with changes."""

    def __init__(self, outputs, kind):
        _Algorithm.__init__(self, nInputPorts=0, nOutputPorts=outputs, outputType=kind)
        self._file = ""

    def SetFileName(self, name):
        self.set("_file", name or "")

    def GetCameraNames(self):
        try:
            return self.whole_scene().cameras
        except (plenoflame.Error, _core.Failure, OSError):
            return []  # RequestData says it

    def steps(self):
        scene = self.whole_scene()
        if not scene.frames:
            return []
        cameras = "cameras[0]" if scene.cameras[0] else "camera"
        rates = [scene[f"{cameras}.sensor.frame_rate"]] + [scene[f"flames[{i}].frame_rate"] for i in range(scene.list_size("flames"))]
        rate = next(float(rate) for rate in rates if float(rate) > 0)
        return [(number - scene.frames[0]) / rate for number in scene.frames]

    def scene(self):
        """That of the chosen camera at the moment."""
        scene = self.whole_scene()
        scene.camera_name = self._camera or scene.cameras[0]
        if not scene.frames:
            return scene
        times = self.steps()
        return scene.at_frame(scene.frames[times.index(self._moment) if self._moment in times else 0])

    def whole_scene(self):
        if not self._file or self._file == "None":
            raise plenoflame.Error("there is no scene: choose a scene file (.toml)")
        scene = plenoflame.Scene(self._file)
        for setting in filter(None, (part.strip() for part in self._settings.split(";"))):
            key, sign, value = setting.partition("=")
            if not sign:
                raise plenoflame.Error(f"Settings: '{setting}' is not KEY=VALUE")
            try:
                scene.get_text(key.strip())
            except KeyError as error:
                raise plenoflame.Error(f"Settings: {error.args[0]}") from None
            scene[key.strip()] = value.strip()
        return scene


SETTINGS = text("Settings", "Settings", "Values of the scene to replace, as --set of the command: KEY=VALUE, several with ; "
                "between, e.g. camera.focus.object_distance=0.9 m; camera.sensor.columns=200. The keys: docs/reference/scene.md")
CAMERA = listed("Camera", "Camera", "Of several cameras: the name of the one that is meant; empty: the first")
FILE = smproperty.xml("""
  <StringVectorProperty name="FileName" label="Scene File" command="SetFileName" number_of_elements="1" animateable="0"
      panel_visibility="default"><FileListDomain name="files"/>
    <Hints><FileChooser extensions="toml" file_description="Plenoflame scenes"/></Hints>
    <Documentation>Scene file (.toml)</Documentation></StringVectorProperty>""")


def _bundles(kind):
    """The properties of bundles of rays."""
    for decorate in (
        whole("Pixel", "Pixel", "Column and row, from the top left: all rays of this pixel; -1 -1: none, or that in the middle "
              "where no other rays are asked for", -1, -1, low=-1),
        flag("UsePoint", "Use Point", "Whether rays start from the point, too"),
        number("Point", "Point", "[m] Rays from this point of the world towards the camera, where Use Point is on", 1.0, 0.0, 0.0),
        whole("Random", "Random Pixels", "All rays of so many pixels drawn at random", 0, low=0),
        flag("Chief", "Chief Rays", "The chief ray of every microlens"),
        whole("Rays", "Rays", "Rays per pixel and microlens that covers it, and per point", 64, low=2),
        whole("FlameSamples", "Flame Samples", "Vertices within the flames, with temperature and absorption", 0, low=0),
        whole("Seed", words("render.seed")[0], words("render.seed")[1] + " -1: as the scene says", -1, low=-1),
    ):
        kind = decorate(kind)
    return kind


class _RayBundles(_OfScene):
    def rays(self, scene):
        pixels = [self._pixel] if self._pixel != (-1, -1) else []
        if not (pixels or self._use_point or self._random or self._chief):
            pixels = [(scene.columns // 2, scene.rows // 2)]
        return scene.rays(pixels=pixels, random=self._random, chief=self._chief,
                          points=[self._point] if self._use_point else [], rays=self._rays,
                          flame_samples=self._flame_samples, seed=self._seed)


@smproxy.reader(name="PlenoflameScene", label="Plenoflame Scene", extensions="toml", file_description="Plenoflame scenes")
@smproperty.xml("""<OutputPort name="Camera" index="0"/><OutputPort name="Flame" index="1"/><OutputPort name="Rays" index="2"/>""")
@_bundles
@whole("Resolution", "Flame Resolution", "Samples of the flames along their longest side", 96, low=2)
@TIMES
@CAMERA
@SETTINGS
class PlenoflameScene(_RayBundles):
    """A scene: the camera's surfaces, its flames on a lattice [K, 1/m], and rays of a chosen pixel (without one, of that in the middle)."""

    def __init__(self):
        super().__init__(3, "vtkMultiBlockDataSet")

    def FillOutputPortInformation(self, port, info):
        info.Set(vtkDataObject.DATA_TYPE_NAME(), ("vtkMultiBlockDataSet", "vtkImageData", "vtkPolyData")[port])
        return 1

    @smproperty.stringvector(name="FileName", panel_visibility="never")
    @smdomain.filelist()
    @smhint.filechooser(extensions="toml", file_description="Plenoflame scenes")
    def SetFileName(self, name):
        super().SetFileName(name)

    def compute(self):
        scene = self.scene()
        flame = owned(scene.flame(self._resolution).to_vtk()) if scene.list_size("flames") else vtkImageData()
        return camera_to_blocks(scene), flame, owned(self.rays(scene).to_vtk())

    def sizes(self, result):
        return {1: result[1].GetDimensions()}

    def fill(self, result, outputs):
        for port, (kind, data) in enumerate(zip((vtkMultiBlockDataSet, vtkImageData, vtkPolyData), result)):
            kind.GetData(outputs, port).ShallowCopy(data)


@smproxy.source(name="PlenoflameRays", label="Plenoflame Rays")
@_bundles
@TIMES
@CAMERA
@SETTINGS
@FILE
class PlenoflameRays(_RayBundles):
    """Paths of rays through the camera of a scene, a line each."""

    def __init__(self):
        super().__init__(1, "vtkPolyData")

    def compute(self):
        return owned(self.rays(self.scene()).to_vtk())

    def fill(self, result, outputs):
        vtkPolyData.GetData(outputs, 0).ShallowCopy(result)


class _Image(_Algorithm):
    """One that gives a single image."""

    def sizes(self, result):
        return {0: result.GetDimensions()}

    def fill(self, result, outputs):
        vtkImageData.GetData(outputs, 0).ShallowCopy(result)


ESTIMATORS = "as the scene says", "backward", "forward"


@smproxy.source(name="PlenoflameLightField", label="Plenoflame Light Field")
@flag("Truth", "Truth", "Adds layers of ground truth, such as truth.distance")
@choice("Estimator", words("render.estimator")[0], words("render.estimator")[1], ESTIMATORS)
@whole("Seed", words("render.seed")[0], words("render.seed")[1] + " -1: as the scene says", -1, low=-1)
@whole("Samples", words("render.samples")[0], words("render.samples")[1] + " 0: as the scene says", 0, low=0)
@TIMES
@CAMERA
@SETTINGS
@FILE
class PlenoflameLightField(_Image, _OfScene):
    """The raw image of a scene's camera: flux per pixel [W] and its standard error."""

    def __init__(self):
        _OfScene.__init__(self, 1, "vtkImageData")

    def compute(self):
        field = self.scene().render(self._samples, seed=self._seed, truth=self._truth, progress=self.progress,
                                    estimator=None if self._estimator == ESTIMATORS[0] else self._estimator)
        return owned(field.to_vtk())


class _File(_Image):
    """A reader of one image."""

    def __init__(self):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkImageData")
        self._file = ""

    def name(self):
        if not self._file:
            raise plenoflame.Error("there is no file: choose one")
        return self._file


@smproxy.reader(name="PlenoflameLightFieldReader", label="Plenoflame Light Field Reader", extensions="exr",
                file_description="Plenoflame light fields")
class PlenoflameLightFieldReader(_File):
    """A light field (.exr) that Plenoflame wrote: channels, standard errors and layers as arrays."""

    @smproperty.stringvector(name="FileName", panel_visibility="never")
    @smdomain.filelist()
    @smhint.filechooser(extensions="exr", file_description="Plenoflame light fields")
    def SetFileName(self, name):
        self.set("_file", name or "")

    def compute(self):
        return owned(plenoflame.read_light_field(self.name()).to_vtk())


@smproxy.reader(name="PlenoflameFlameReader", label="Plenoflame Flame Reader", extensions="vdb", file_description="OpenVDB grids")
@text("Grid", "Grid", "One grid by its name; empty: temperature [K] and absorption [1/m] of a flame")
@TIMES
@smproperty.xml("""
  <StringVectorProperty name="FileName" command="AddFileName" clean_command="ClearFileNames" repeat_command="1" number_of_elements="0"
      number_of_elements_per_command="1" animateable="0" panel_visibility="never"><FileListDomain name="files"/>
    <Hints><FileChooser extensions="vdb" file_description="OpenVDB grids"/></Hints>
    <Documentation>Files (.vdb), one for each whole number of the time</Documentation></StringVectorProperty>""")
class PlenoflameFlameReader(_File):
    """Grids of OpenVDB files (.vdb), where their transforms place them: scaled, moved, turned or sheared."""

    def __init__(self):
        super().__init__()
        self._files = []

    def ClearFileNames(self):
        self.set("_files", [])

    def AddFileName(self, name):
        self.set("_files", self._files + [name] * bool(name))

    def steps(self):
        return [float(number) for number in range(len(self._files))] if len(self._files) > 1 else []

    def compute(self):
        self._file = self._files[int(self._moment or 0)] if self._files else ""
        return owned(plenoflame.read_flame(self.name(), grid=self._grid).to_vtk())


# --- filters of light fields ---

def _filter(name, label, documentation):
    """What filters have in common."""
    def decorate(kind):
        kind.__doc__ = documentation
        kind = smdomain.datatype(dataTypes=["vtkImageData"], composite_data_supported=False)(kind)
        kind = smproperty.input(name="Input", port_index=0)(kind)
        return smproxy.filter(name=name, label=label)(kind)
    return decorate


class _Filter(_Algorithm):
    def __init__(self):
        super().__init__(nInputPorts=1, nOutputPorts=1, outputType="vtkImageData")

    def GetChannelNames(self):
        data = self.GetInputDataObject(0, 0) if self.GetNumberOfInputConnections(0) else None
        names = data and data.GetFieldData().GetAbstractArray("plenoflame.channels")
        return [names.GetValue(i) for i in range(names.GetNumberOfValues())] if names else []

    def FillInputPortInformation(self, _port, info):
        info.Set(self.INPUT_REQUIRED_DATA_TYPE(), "vtkImageData")
        return 1

    def sizes(self, result):
        return {0: result.GetDimensions()}

    def RequestInformation(self, request, inputs, outputs):
        """How large the picture becomes is known when it is made: of a light field that has to be there before."""
        port = self.GetInputConnection(0, 0)
        port.GetProducer().Update(port.GetIndex())
        return super().RequestInformation(request, inputs, outputs)

    def RequestUpdateExtent(self, request, inputs, outputs):
        """All of the light field, whatever part of the picture is wanted."""
        upstream = inputs[0].GetInformationObject(0)
        upstream.Set(vtkStreamingDemandDrivenPipeline.UPDATE_EXTENT(),
                     upstream.Get(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT()), 6)
        return 1

    def time(self):
        return self.GetMTime(), self.GetInputDataObject(0, 0).GetMTime()

    def compute(self):
        return owned(self.make(plenoflame.LightField.from_vtk(self.GetInputDataObject(0, 0))))

    def fill(self, result, outputs):
        vtkImageData.GetData(outputs, 0).ShallowCopy(result)


@_filter("PlenoflameViews", "Plenoflame Views", "Sub-aperture views of a light field side by side, or one of them.")
@CHANNEL
@flag("WhiteCorrection", "White Correction", "Divides by the light of a uniform scene, so that values are radiances "
      "[W/(m^2 sr)]; off: flux per pixel [W]", 1)
@choice("Resampling", "Resampling", "How one sample per microlens becomes a picture with square pixels",
        ("nearest", "barycentric", "paper9", "paper10"), 1)
@number("Spread", "Spread", "Side of the square over which the views' middles are spread, in diameters of the stop's image", 0.7)
@whole("View", "View", "Row and column of one view; -1 -1: all of them, side by side", -1, -1, low=-1)
@whole("Grid", "Grid", "Views along each side", 7, low=1)
class PlenoflameViews(_Filter):
    def make(self, field):
        views = field.views(self._grid, spread=self._spread, white_correction=self._white_correction, channel=self._channel,
                            progress=self.progress, resampling=self._resampling)
        if self._view == (-1, -1):
            picture = views.sheet
        else:
            try:
                picture = views[self._view]
            except IndexError as error:
                raise plenoflame.Error(str(error)) from None
        return picture_to_image({"radiance" if self._white_correction else "flux": picture})


@_filter("PlenoflameRefocus", "Plenoflame Refocus", "The picture of a lens that is focused on a plane, in metres on that plane.")
@CHANNEL
@number("Aperture", "Aperture", "Of the synthetic lens, in diameters of the main lens' stop", 1.0)
@whole("Width", "Width", "Pixels of the picture; 0: one per microlens across", 0, low=0)
@number("Depth", "Depth", "[m] Of the plane in front of the main lens", 1.0)
class PlenoflameRefocus(_Filter):
    def make(self, field):
        sharp = field.refocus(self._depth, width=self._width, aperture=self._aperture, channel=self._channel, progress=self.progress)
        # The picture's y runs downwards, VTK's upwards.
        return picture_to_image({"radiance": sharp.image}, sharp.pixel, (sharp.x[0], -sharp.y[-1]))


@_filter("PlenoflameDevelop", "Plenoflame Develop", "Digital numbers that a sensor makes of a light field, without noise.")
@CHANNEL
@choice("Curve", words("develop.curve")[0], words("develop.curve")[1], ("display", "linear"))
@whole("Bits", words("develop.bits")[0], words("develop.bits")[1], 14, low=1)
@number("Saturation", words("develop.saturation")[0], words("develop.saturation")[1], 0.0)
class PlenoflameDevelop(_Filter):
    def make(self, field):
        x, y, _, height = field.window
        picture = field.develop(saturation=self._saturation, bits=self._bits, curve=self._curve,
                                channel=self._channel)
        return picture_to_image({"digital_number": picture}, 1,
                                (x + 0.5, field._data.sensor[1] - y - height + 0.5))
