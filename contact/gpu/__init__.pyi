from .rubs import DeviceRuns, device_runs

__all__ = ["DeviceRuns", "device_runs"]
