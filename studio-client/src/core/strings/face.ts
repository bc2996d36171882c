// What the mode of faces says.

import type { Strings } from "./strings";

export const FACE = {
  modeFace: ["Face", "人脸"],
  hintFace: [
    "Drop a photograph of a face. The sliders exaggerate what sets it apart; double-click one to reset it.",
    "拖入一张人脸照片。滑块会夸大其特征，双击滑块可复位。",
  ],
  noFace: ["Drop a photograph here, and its face becomes the shape.", "将照片拖到此处，其中的人脸会成为形状。"],
  choosePhotograph: ["Choose a photograph …", "选择照片…"],
  anotherPhotograph: ["Another photograph …", "另一张照片…"],
  exampleFace: ["Try an astronaut", "试试宇航员"],
  faceFeatures: ["Features", "部位"],
  faceExpression: ["Along with them", "一并夸张"],
  face_amount: ["Caricature", "漫画化"],
  face_brows: ["Brows", "眉"],
  face_eyes: ["Eyes", "眼"],
  face_nose: ["Nose", "鼻"],
  face_mouth: ["Mouth", "嘴"],
  face_chin: ["Chin", "下巴"],
  face_cheeks: ["Cheeks", "脸颊"],
  face_outline: ["Outline", "轮廓"],
  face_expression: ["Expression", "表情"],
  faceFoldFree: ["Nothing folds", "无折叠"],
  faceFolds: ["The face folds", "面部折叠"],
  resetCaricature: ["Reset", "重置"],
  faceHandles: ["Handles", "手柄"],
  faceLandmarks: ["Landmarks", "标志点"],
  faceNumber: ["Face", "人脸"],
  nextFace: ["Next face", "下一张脸"],
  did_caricature: ["Caricature", "漫画化"],
  faceTourPhoto: ["A face from a photograph", "由照片生成人脸"],
  faceTourPhotoText: [
    "Drop a picture of a face seen from the front, or choose one. It is found, turned, and wears the photograph; nothing leaves this machine.",
    "拖入或选择一张正面人脸照片。程序会找到并摆正人脸并贴上照片；数据不会离开本机。",
  ],
  faceTourSliders: ["Its caricature", "漫画化"],
  faceTourSlidersText: [
    "Where there is a face, sliders stand here: the first goes away from the mean face, or towards it; the others say how much each feature takes part.",
    "有了人脸后，这里会出现滑块：第一个远离或接近平均脸，其余滑块决定各部位的参与程度。",
  ],
} as const satisfies Strings;
