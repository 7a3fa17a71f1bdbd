"""For pvbatch: reads XDMF files with each of ParaView's readers and writes the results to a file.

paraview_reads.py OUT XDMF...
"""

import pickle
import sys

from paraview import servermanager
from paraview.simple import IntegrateVariables, Slice, XDMFReader, Xdmf3ReaderS, Xdmf3ReaderT
from vtkmodules.numpy_interface import dataset_adapter

READERS = {
    "XDMF": lambda path: XDMFReader(FileNames=[path]),
    "Xdmf3 S": lambda path: Xdmf3ReaderS(FileName=[path]),
    "Xdmf3 T": lambda path: Xdmf3ReaderT(FileName=[path]),
}


def fetched(source):
    data = servermanager.Fetch(source)
    while not data.IsA("vtkDataSet"):
        data = data.GetPiece(0) if data.IsA("vtkMultiPieceDataSet") else data.GetBlock(0)
    return data


def points(data):
    return [data.GetPoint(number) for number in range(data.GetNumberOfPoints())]


def area(source, normal, time):
    plane = Slice(Input=source)
    plane.SliceType.Normal = normal
    total = IntegrateVariables(Input=plane)
    total.UpdatePipeline(time)
    return fetched(total).GetCellData().GetArray("Area").GetValue(0)


def frames(reader):
    reader.UpdatePipelineInformation()
    for time in list(reader.TimestepValues):
        reader.UpdatePipeline(time)
        data = fetched(reader)
        velocity = dataset_adapter.WrapDataObject(data).PointData["velocity"]
        areas = [area(reader, normal, time) for normal in ([1, 0, 0], [0, 1, 0], [0, 0, 1])]
        yield {"time": time, "points": points(data), "velocity": velocity.tolist(), "areas": areas}


read = {name: [list(frames(make(path))) for path in sys.argv[2:]] for name, make in READERS.items()}
with open(sys.argv[1], "wb") as out:
    pickle.dump(read, out)
